"""The columns that a correction appends."""

DISTANCE = "corrected_distance_m"
LEVEL = "corrected_level_m"
"""In place of `DISTANCE` where the table holds a level."""
UNCERTAINTY = "distance_standard_uncertainty_m"
STATUS = "status"
UNUSABLE = "unusable"
"""The former name of `STATUS`, written beside it for one version."""

RESULTS = (DISTANCE, UNCERTAINTY, STATUS, UNUSABLE)
"""Names of all of them, in this order."""


def results(first: str) -> tuple[str, ...]:
    """Names of all of them, where the first is `DISTANCE` or `LEVEL`."""
    return (first, *RESULTS[1:])
