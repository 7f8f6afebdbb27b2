"""Tables with a planted effect, made by physics that the engine does not know."""
