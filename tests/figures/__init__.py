"""The claims of the paper, figure by figure."""
