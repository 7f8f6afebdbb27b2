"""What the members of a credible set predict, and the rows that tell them apart."""
