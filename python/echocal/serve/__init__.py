"""A page in the browser of this machine: from a log to its report, its model and its C."""
