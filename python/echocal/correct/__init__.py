"""Correction: it appends a corrected distance to a table."""

from echocal.correct.batch import correct_files
from echocal.correct.driver import Summary
from echocal.correct.files import correct_file, correct_folder
from echocal.correct.tables import Corrected, correct, correct_table

__all__ = [
    "Corrected",
    "Summary",
    "correct",
    "correct_file",
    "correct_files",
    "correct_folder",
    "correct_table",
]
