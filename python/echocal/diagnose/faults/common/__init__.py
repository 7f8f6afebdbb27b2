"""What faults share: the type of an entry, settings, the search, and tools of the detectors."""
