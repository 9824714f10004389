"""The benchmark suite: the paper's tables and figures, quality, scaling and peers in one report."""
