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
  local section page link links
  for section in "The paper" "Quality and peers" "The map to the sphere" "Scaling" "Gallery"; do
    grep -qxF "## $section" "$report/report.md" || return 1
  done
  for page in "$report/report.md" "$report/gallery/README.md"; do
    links=0
    while read -r link; do
      links=$((links + 1))
      [ -s "$(dirname "$page")/$link" ] || {
        echo "$page: $link is missing or empty"
        return 1
      }
    done < <(grep -oE '\]\([^)]+\)' "$page" | sed 's/^](\(.*\))$/\1/')
    [ "$links" -gt 0 ] || return 1
  done
}

check "benchmark.sh --quick" bash -euc "$(doc_block doc/benchmarks.md 1)" || finish
check "the report is whole" report_is_whole || true
finish
