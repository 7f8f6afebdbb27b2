"""The virtual bench: a second, independent world, which imports nothing of the laws and effects."""
