"""Judges a folding solution by the paper's own definition of validity, sharing nothing with the search."""
