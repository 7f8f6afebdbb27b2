"""What is claimed: causes, noises and faults with their rivals, and what remains."""
