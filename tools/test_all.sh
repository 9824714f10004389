#!/usr/bin/env bash
# All scripts that test something, each in full but for the stress tests: an hour or two. The weekly workflow and the
# release run it.
set -euo pipefail
exec "$(dirname "${BASH_SOURCE[0]}")/common/run_scripts.sh" test test_clang test_ros test_python test_docs \
  test_package test_browser test_cluster test_benchmark "stress --quick"
