"""Readings at the level of waveforms: burst, paths, voltage, comparator."""
