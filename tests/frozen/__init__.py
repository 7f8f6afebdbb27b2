"""Three hundred tables, and what the diagnosis says of each: what a change must not change."""
