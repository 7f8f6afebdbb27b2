"""A ruler experiment: where the target goes next, readings of each placement, and when it is enough."""
