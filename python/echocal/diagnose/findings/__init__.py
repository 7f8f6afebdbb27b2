"""What the stages pass on: facts of a cause, findings, claims, gains."""
