"""Text files: every line stays as it is, and the results are appended to it."""
