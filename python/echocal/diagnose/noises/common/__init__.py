"""What noises share: the kinds of an entry, settings, and how each kind is compared."""
