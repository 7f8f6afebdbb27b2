"""The columns that a correction appends."""

__all__ = ["DISTANCE", "KNOWN_BY", "RESULTS", "STATUS", "UNCERTAINTY", "UNUSABLE"]

DISTANCE = "corrected_distance_m"
UNCERTAINTY = "distance_standard_uncertainty_m"
STATUS = "status"
UNUSABLE = "unusable"
"""The former name of `STATUS`, written beside it for one version."""

RESULTS = (DISTANCE, UNCERTAINTY, STATUS, UNUSABLE)
"""Names of all of them, in this order."""

KNOWN_BY = frozenset((DISTANCE, UNUSABLE))
"""Columns by which a corrected table is recognized, also one of an earlier version."""
