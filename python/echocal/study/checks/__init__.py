"""How each claim is recomputed; importing this package registers every check."""

from echocal.study.checks import air, benchmarks, columns, pressure_humidity

__all__ = ["air", "benchmarks", "columns", "pressure_humidity"]
