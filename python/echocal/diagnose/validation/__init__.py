"""The claims and the gain on cross-validated or held-out rows."""
