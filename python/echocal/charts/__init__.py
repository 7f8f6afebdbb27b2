"""What the figures of results show: one description of each, for the page and for the picture."""
