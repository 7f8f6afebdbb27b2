"""Sums over the rows, noise models, and how probable each hypothesis is.

Here, noise models are the correlations that every hypothesis includes (`noise`; computed by
rust/infer/src/noise). Noises that a diagnosis reports are in `echocal.diagnose.noises`.
"""
