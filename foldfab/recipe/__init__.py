"""A file becomes a Recipe."""
