#!/usr/bin/env bash
# Tests of the page of -report in a real browser: Debian's chromium, without a window. The last line
# counts the tests.
#
#   tools/test_browser.sh
#
# Logs and pictures of the page are in build/test-logs.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=tools/common/test_steps.sh
. tools/common/test_steps.sh

# browser_tests <step> <kind> <page> <folder>: one test for each line of "results".
browser_tests() {
  local step="$1" results="$4/results" good=yes bad total
  rm -f "$results"
  run "$step" timeout 600 /usr/bin/python3 test/browser/test_report_page.py "$2" "$3" "$4" ||
    good=no
  total="$(grep -c . "$results" 2>/dev/null || true)"
  bad="$(grep -vc '^ok ' "$results" 2>/dev/null || true)"
  if [ "$good" = no ] && [ "${bad:-0}" -eq 0 ]; then
    failed=$((failed + 1)) # of what did not come to its end
  fi
  passed=$((passed + ${total:-0} - ${bad:-0}))
  failed=$((failed + ${bad:-0}))
}

# A report of an open cloud, whose mesh has a lid, with smoothing: the cloud differs from the mesh.
make_real_report() {
  local bin=build/release/bin
  "$bin/pcl_spherical_param_scan" bowl "$work/bowl.ply" -points 3000 &&
    "$bin/pcl_spherical_param_reconstruction" "$work/bowl.ply" "$work/mesh.ply" \
      -smooth 3 -report "$work/bowl.html"
}

knows_report() {
  # Not a pipe: grep ends at the first line that fits, and the tool could fail to write the rest.
  local help
  help="$(build/release/bin/pcl_spherical_param_reconstruction -h)" &&
    grep -q -- '-report ' <<<"$help"
}

need_packages browser
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

if check "page and tools: build" build_release spherical_param_report_page \
  pcl_spherical_param_scan pcl_spherical_param_reconstruction; then
  page=build/release/tools/report/report_page.html
  if [ -f "$page" ]; then
    browser_tests "page with made-up data" made-up "$page" "$logs/browser"
    if ! knows_report; then
      skip "page with data of the tool" "the tool has no -report"
    elif check "report of the tool" make_real_report; then
      browser_tests "page with data of the tool" real "$work/bowl.html" "$logs/browser-real"
    fi
  else
    skip "tests of the page" "it could not be built, see $logs/page_and_tools__build.log"
  fi
fi

finish
