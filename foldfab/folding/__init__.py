"""A Scaffold becomes a FoldSolution (sections 5.2 to 5.7)."""
