"""What each cause, and each unexplained term, would add to the readings."""
