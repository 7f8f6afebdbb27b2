"""The diagnosis as a person reads it: its sentences, notes, steps of the level and classes."""
