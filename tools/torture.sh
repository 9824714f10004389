#!/usr/bin/env bash
# shellcheck disable=SC2317  # functions are called by name, by part
# Nothing breaks it, nothing is lost: fuzzed files and calls, nasty sets of points, clouds that are
# no spheres, faults, threads, long runs.
#
#   tools/torture.sh            everything: hours
#   tools/torture.sh --quick    a minute's worth of each, which CI runs
#   --models FOLDER             with either: also the models of a folder, .ply
#
# The last lines are a table of what was tried, injected, found and lost; it is in
# build/torture/table.md, too. Logs are in build/test-logs.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
quick=()
models=()
while [ $# -gt 0 ]; do
  case "$1" in
  --quick) quick=(--quick) ;;
  --models)
    models=(--models "$(realpath -e "${2:?a folder is missing}")")
    shift
    ;;
  *)
    sed -n -e '3,11s/^# \{0,1\}//p' tools/torture.sh
    exit 2
    ;;
  esac
  shift
done

# shellcheck source=tools/common/test_steps.sh
. tools/common/test_steps.sh

work="$PWD/build/torture"
rm -rf "$work"
mkdir -p "$work"
: >"$work/rows"
export UBSAN_OPTIONS=print_stacktrace=1
# Clang's OpenMP does not give back what it has for each thread.
echo 'leak:libomp' >"$logs/leaks-of-others"
export LSAN_OPTIONS="suppressions=$PWD/$logs/leaks-of-others:print_suppressions=0"

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

if check "readers: build" configure_and_build asan reader_fuzzers; then
  part "readers: fuzz" test/torture/readers/run_fuzzers.py "${quick[@]}" \
    build/asan/bin "$work/readers" || true
fi

# --- core ----------------------------------------------------------------------------------------

core_fuzzers() {
  configure_and_build asan fuzz_reconstruct fuzz_stages >"$work/core-build.log" 2>&1 ||
    { tail -n 40 "$work/core-build.log"; return 1; }
  mkdir -p "$work/core"
  test/torture/core/run_fuzzers.sh build/asan/bin "$work/core" "${quick[@]}"
}
part "core: fuzzed calls" core_fuzzers || true

# --- shapes --------------------------------------------------------------------------------------

if check "shapes: build" build_release torture_shapes; then
  part "shapes" build/release/bin/torture_shapes "${quick[@]}" || true
fi

# --- surfaces ------------------------------------------------------------------------------------
if check "surfaces: build" build_release torture_surfaces; then
  part "surfaces: not spheres, and closed ones" build/release/bin/torture_surfaces "${quick[@]}" ||
    true
fi

# --- faults --------------------------------------------------------------------------------------

if run "build of the faults" build_release torture_allocation pcl_spherical_param_reconstruction \
  pcl_spherical_param_remesh pcl_spherical_param_morph pcl_spherical_param_texture \
  pcl_spherical_param_scan; then
  part "faults: allocations" build/release/bin/torture_allocation "${quick[@]}" || true
  part "faults: files and signals" test/torture/faults/torture_files.py "${quick[@]}" || true
else
  failed=$((failed + 1))
fi

# --- threads -------------------------------------------------------------------------------------

bin=build/release/bin
if check "threads: build" build_release torture_threads_pcl torture_soak \
  torture_meshes; then
  part "threads: together as alone" "$bin/torture_threads_pcl" "${quick[@]}" || true
  part "threads: soak" "$bin/torture_soak" "${quick[@]}" || true
  part "threads: determinism" "$bin/torture_meshes" "${quick[@]}" "${models[@]}" || true
fi
if check "threads: build with the thread sanitizer" configure_and_build tsan torture_threads; then
  part "threads: thread sanitizer" build/tsan/bin/torture_threads "${quick[@]}" || true
fi
if [ ${#quick[@]} -eq 0 ]; then
  part "threads: gcc and clang" test/torture/threads/compare_builds.py --build "${models[@]}" || true
fi

# --- sanitizers ----------------------------------------------------------------------------------

# The tests that tools/test.sh leaves out, too.
if [ ${#quick[@]} -eq 0 ] && check "sanitizers: build" configure_and_build asan; then
  tests "sanitizers: all tests" build/asan -E '^(Layering|Benchmark|test_shapes_are_meshed)'
fi

# --- end -----------------------------------------------------------------------------------------

table | tee "$work/table.md"
finish
