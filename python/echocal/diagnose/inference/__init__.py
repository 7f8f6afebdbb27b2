"""Sums over the rows, noise models, and how probable each hypothesis is."""
