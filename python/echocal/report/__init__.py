"""Reports on the terminal."""

from echocal.report.diagnosis import print_diagnosis

__all__ = ["print_diagnosis"]
