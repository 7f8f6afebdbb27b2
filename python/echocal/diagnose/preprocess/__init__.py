"""Usable rows, and their grouping into series, stations, segments and folds."""
