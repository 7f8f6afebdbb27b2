"""The claims and the gain on cross-validated or held-out rows.

The folds are chosen before the columns are built: `echocal.diagnose.preprocess.folds`.
"""
