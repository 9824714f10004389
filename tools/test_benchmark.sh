#!/usr/bin/env bash
# Tests that tools/benchmark.sh --quick makes a whole report.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=tools/common/test_steps.sh
. tools/common/test_steps.sh

report=build/benchmark
rm -rf "$report"

# Every table, plot and picture that the report links to is there.
report_is_whole() {
  local section link links=0
  for section in "The paper" "Quality and peers" "The map to the sphere" "Scaling"; do
    grep -qxF "## $section" "$report/report.md" || return 1
  done
  while read -r link; do
    links=$((links + 1))
    [ -s "$report/$link" ] || {
      echo "$report/$link is missing or empty"
      return 1
    }
  done < <(grep -oE '\]\([^)]+\)' "$report/report.md" | sed 's/^](\(.*\))$/\1/')
  [ "$links" -gt 0 ]
}

check "benchmark.sh --quick" bash -euc "$(doc_block doc/benchmarks.md 1)" || finish
check "the report is whole" report_is_whole || true
finish
