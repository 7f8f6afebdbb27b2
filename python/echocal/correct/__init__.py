"""Correction: it appends a corrected distance to a table."""

from echocal.correct.files import correct_file, correct_folder
from echocal.correct.tables import Corrected, correct_table

__all__ = ["Corrected", "correct_file", "correct_folder", "correct_table"]
