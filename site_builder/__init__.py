"""What MkDocs needs beyond its plugins: generated pages, mathematics without a script, compiled functions."""
