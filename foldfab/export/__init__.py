"""An Assembly becomes files."""
