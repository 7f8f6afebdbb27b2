"""Compensation under real conditions: `python benches/compensation --write`."""
