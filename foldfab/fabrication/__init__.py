"""A FoldSolution becomes an Assembly."""
