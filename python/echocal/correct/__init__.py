"""Correction: it appends a corrected distance to a table."""

from echocal._verb import callable_as
from echocal.correct.batch import correct_files
from echocal.correct.driver import Summary
from echocal.correct.tables import Corrected, correct, correct_table

__all__ = [
    "Corrected",
    "Summary",
    "correct",
    "correct_files",
    "correct_table",
]

callable_as(__name__)
