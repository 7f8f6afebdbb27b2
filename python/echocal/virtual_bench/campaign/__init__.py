"""Campaigns: designs as people run them, the causes that act in them, and the tables that come out."""
