#!/usr/bin/env bash
# shellcheck disable=SC2317  # functions are called by name, by part
# Nothing breaks it, nothing is lost: fuzzed files and calls, nasty sets of points, clouds that are
# no spheres, faults, threads, long runs.
#
#   tools/torture.sh            everything: hours
#   tools/torture.sh --quick    a minute's worth of each, which CI runs
#
# The last lines are a table of what was tried, injected, found and lost; it is in
# build/torture/table.md, too. Logs are in build/test-logs.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
quick=()
case "${1:-}" in
"") ;;
--quick) quick=(--quick) ;;
*)
  sed -n -e '3,10s/^# \{0,1\}//p' tools/torture.sh
  exit 2
  ;;
esac

# shellcheck source=tools/common/test_steps.sh
. tools/common/test_steps.sh

work="$PWD/build/torture"
rm -rf "$work"
mkdir -p "$work"
: >"$work/rows"

# part <step> <command>...: a step whose output has rows of the table.
part() {
  local good=yes
  check "$@" || good=no
  grep -h '^row: ' "$logs/${1//[^A-Za-z0-9]/_}.log" | sed 's/^row: //' >>"$work/rows" || true
  [ "$good" = yes ]
}

table() {
  echo '| part | load held | inputs tried | faults injected | found | lost |'
  echo '|---|---|---:|---:|---:|---:|'
  sed -e 's/^/| /' -e 's/$/ |/' "$work/rows"
}

# --- readers -------------------------------------------------------------------------------------

# --- core ----------------------------------------------------------------------------------------

# --- shapes --------------------------------------------------------------------------------------

# --- surfaces ------------------------------------------------------------------------------------

# --- faults --------------------------------------------------------------------------------------

# --- threads -------------------------------------------------------------------------------------

# --- end -----------------------------------------------------------------------------------------

table | tee "$work/table.md"
finish
