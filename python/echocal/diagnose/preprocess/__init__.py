"""Which rows are used, and how they belong together."""
