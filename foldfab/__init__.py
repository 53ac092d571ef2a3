"""Foldabilizing furniture: from parts and a folding direction to a print that folds flat.

recipe = foldfab.load("bench.json")
solution = foldfab.foldabilize(recipe)
assembly = foldfab.fabricate(solution)
foldfab.write(assembly, "prints/bench")
"""

from foldfab.errors import FoldfabError
from foldfab.pipeline import check, compound, fabricate, foldabilize, load, shipped, verify, write

__all__ = ["FoldfabError", "check", "compound", "fabricate", "foldabilize", "load", "shipped", "verify", "write"]
