"""Plots of results: each takes a result and an axes, and computes nothing."""
