"""Claims before rows that no fit saw, and the gain measured there."""
