"""What tools/benchmark.sh runs: a module for each section of the report."""
