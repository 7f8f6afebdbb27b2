"""The claims: causes with those that the data cannot separate from them, and the unexplained term."""
