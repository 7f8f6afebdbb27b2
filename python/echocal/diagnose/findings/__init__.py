"""What a diagnosis is made of, and how its numbers are said."""
