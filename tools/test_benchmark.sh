#!/usr/bin/env bash
# Tests that tools/benchmark.sh --quick makes a whole report, and that no clean cloud is lost unseen.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=tools/common/test_steps.sh
. tools/common/test_steps.sh

report=build/benchmark
rm -rf "$report"

# Every table, plot and picture that the report links to is there.
report_is_whole() {
  local section link links=0
  for section in "The paper" "Quality and peers" "Scans" "The map to the sphere" "Scaling" "Gallery"; do
    grep -qxF "## $section" "$report/report.md" || return 1
  done
  while read -r link; do
    links=$((links + 1))
    [ -s "$report/$link" ] || {
      echo "$link is missing or empty"
      return 1
    }
  done < <(grep -oE '\]\([^)]+\)' "$report/report.md" | sed 's/^](\(.*\))$/\1/')
  [ "$links" -gt 0 ]
}

# Handles, openings and bridges are counted, and times beside busy processes measured.
tables_are_right() {
  cat "$report"/{handles,views,merged,scans,race}.csv
  grep -q '^| chair_2000 | ours | 4 | 4 | yes | 0 |' "$report/report.md" &&
    grep -qE '^\| desk_[0-9]+ \| [0-9,]+ \| ours \| [0-9.]+ \| 0 \| [0-9.]+ \| [0-9.]+ \|' "$report/report.md" &&
    grep -qE '^\| desk_[0-9]+ \| [0-9,]+ \| PCL organized mesh \| [0-9.]+ \| [0-9,]+ \|' "$report/report.md" &&
    grep -qE '^\| animal \| 0.5 \| [0-9,]+ \| ours \| yes \| 0 \|' "$report/report.md" &&
    grep -q '^| rabbit | 12,000 | ours | no | yes | 100.00 | 1 | 4 | 0 | 0 |' "$report/report.md" &&
    grep -qxF model,ours,single,gain,ours_busy,single_busy "$report/race.csv"
}

# suite <folder> <argument>...
suite() {
  PYTHONPATH=test/benchmark:tools PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 -m suite "$report/$1" "${@:2}" \
    --build build/release
}

# Models with handles are judged by the genus of their truth, apart from the others.
handles_are_judged_apart() {
  local models="$report/models" name
  mkdir -p "$models/points" "$models/truth"
  for name in animal torus; do
    build/release/bin/pcl_spherical_param_scan "$name" "$models/points/$name.ply" -points 500 \
      -truth "$models/truth/$name.ply"
  done
  suite apart "$models" --quick --only comparison || return 1
  grep -q '^| torus | ours | 1 | 1 | yes |' "$report/apart/report.md" &&
    ! grep -q '^torus' "$report/apart/models.csv" && grep -q '^animal' "$report/apart/models.csv"
}

# compare_clean [<option>...]: with a list and clouds of this test.
compare_clean() {
  suite clean --only clean --clean "$report/clouds" --clean-list "$report/clean.txt" "$@"
}

# is_lost <line of the list> <result>: with this line in the list, the suite fails and says why.
is_lost() {
  echo "$1" >"$report/clean.txt"
  ! compare_clean >"$report/clean.log" 2>&1 || return 1
  cat "$report/clean.log"
  grep -q "no longer as clean as in the list: ${1%% *}\$" "$report/clean.log" &&
    grep -q "^| ${1%% *} | lost | .*$2" "$report/clean/report.md"
}

clean_clouds_are_kept() {
  local scan=build/release/bin/pcl_spherical_param_scan
  mkdir -p "$report/clouds"
  "$scan" sphere "$report/clouds/stray.xyz" -points 300
  echo "9 9 9" >>"$report/clouds/stray.xyz"
  "$scan" animal "$report/clouds/tangle.ply" -points 300 -noise 5
  # A sphere and a line with three bends, which has no surface.
  "$scan" sphere "$report/clouds/line.xyz" -points 600
  awk 'BEGIN { for (i = 0; i < 200; ++i) { a = i / 100 * atan2(0, -1); r = 1.1 + 0.16 * cos(3 * a)
                 print 7 + r * cos(a), r * sin(a), 0 } }' >>"$report/clouds/line.xyz"
  rm -f "$report/clean.txt"
  compare_clean --update-clean || return 1
  # What is clean is in the list, and stays so; what is missing is named.
  [ "$(grep -v '^#' "$report/clean.txt" | tr -s ' ')" = "stray 301 1 0 0 1 0" ] || return 1
  echo "away 1 1 0 0 0 0" >>"$report/clean.txt"
  compare_clean || return 1
  grep -q '^| away | not found' "$report/clean/report.md" || return 1
  grep -q '^| stray | as before' "$report/clean/report.md" || return 1
  is_lost "tangle 300 1 0 0 0 0" folded &&
    is_lost "line 800 1 0 0 200 0" "1 part cannot be meshed" &&
    is_lost "stray 301 1 0 0 0 0" "points left out 0 -> 1" || return 1
  # An update does not hide it.
  ! compare_clean --update-clean && grep -q "^stray .* 0 0$" "$report/clean.txt"
}

check "benchmark.sh --quick" bash -euc "$(doc_block doc/reference.md 1)" || finish
check "the report is whole" report_is_whole || true
check "handles, openings and bridges are counted" tables_are_right || true
check "models with handles are judged apart" handles_are_judged_apart || true
check "clean clouds are kept" clean_clouds_are_kept || true
finish
