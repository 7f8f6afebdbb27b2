"""Sums over the rows, the noise that is reckoned with, and how probable each set of causes is."""
