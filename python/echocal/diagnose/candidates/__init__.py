"""What each cause, and each shape without one, would add to the readings."""
