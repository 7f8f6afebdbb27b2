"""The ranges of ``--can-vary``."""

from collections.abc import Iterable

from echocal.errors import UsageError


def parsed_ranges(texts: Iterable[str]) -> dict[str, tuple[float, float]]:
    """Read several ranges, each of another condition."""
    ranges: dict[str, tuple[float, float]] = {}
    for text in texts:
        name, ends = _parsed(text)
        if name in ranges:
            low, high = ranges[name]
            raise UsageError(
                f"--can-vary gives {name} twice: {low:g}:{high:g} and {ends[0]:g}:{ends[1]:g}; give one range"
            )
        ranges[name] = ends
    return ranges


def _parsed(text: str) -> tuple[str, tuple[float, float]]:
    """Read ``distance=0.2:4``."""
    name, equals, ends = text.partition("=")
    low, colon, high = ends.partition(":")
    try:
        if equals and colon:
            return name, (float(low), float(high))
    except ValueError:
        pass
    raise UsageError(f"--can-vary '{text}' is not a range such as distance=0.2:4")
