"""Furniture from other programs: files of shapes become a Recipe."""
