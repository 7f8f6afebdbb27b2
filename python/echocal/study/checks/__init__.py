"""How each claim is recomputed; importing this package registers every check."""

from echocal.study.checks import (
    air,
    benchmarks,
    columns,
    compensation,
    instruments,
    pressure_humidity,
    regressions,
    statistics,
    tinkercad,
)

__all__ = [
    "air",
    "benchmarks",
    "columns",
    "compensation",
    "instruments",
    "pressure_humidity",
    "regressions",
    "statistics",
    "tinkercad",
]
