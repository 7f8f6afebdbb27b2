"""Parquet files: the results are appended, and all that was there is copied byte by byte."""
