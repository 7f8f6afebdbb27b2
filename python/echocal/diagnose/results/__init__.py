"""The diagnosis as data and as text: sentences, notes, level steps, classes of causes."""
