# Steps of test scripts and their count. To be sourced, after cd to the project's root.
#
# shellcheck shell=bash

# Nothing here asks questions; a tool that tried to must not hang.
exec </dev/null
jobs="$(nproc)"
logs=build/test-logs
mkdir -p "$logs"
passed=0
failed=0
skipped=0

# What was compiled with the same settings in another folder is not compiled again.
use_compiler_cache() {
  if command -v ccache >/dev/null; then
    export CMAKE_C_COMPILER_LAUNCHER=ccache CMAKE_CXX_COMPILER_LAUNCHER=ccache
    # Its usual folder, also where HOME is another.
    export CCACHE_DIR="${CCACHE_DIR:-$(ccache --get-config cache_dir)}"
    export CCACHE_BASEDIR="$PWD" CCACHE_NOHASHDIR=yes
    export CCACHE_SLOPPINESS=pch_defines,time_macros # which precompiled headers need
  fi
}
use_compiler_cache

# CMake is to find the Python of the system, which has the packages, not one before it in the PATH.
export Python3_ROOT=/usr

# Programs with sanitizers say where.
export UBSAN_OPTIONS=print_stacktrace=1

# usage: ends the script with the comment at its top.
usage() {
  awk 'NR > 1 && !/^# shellcheck/ { if (!sub(/^# ?/, "")) exit; print }' "tools/${0##*/}"
  exit 2
}

# quick_option <argument>...: sets `quick` to yes or no.
quick_option() {
  case "$*" in
  "") quick=no ;;
  # shellcheck disable=SC2034  # the script asks for it
  --quick) quick=yes ;;
  *) usage ;;
  esac
}

report() { # <result> <seconds> <step>
  printf '%-6s %5ss  %s\n' "$1" "$2" "$3"
}

# run <step> <command>...: runs it with its output in a log, which is shown if it fails.
run() {
  local step="$1" log="$logs/${1//[^A-Za-z0-9]/_}.log" start="$SECONDS"
  shift
  if "$@" >"$log" 2>&1; then
    report ok "$((SECONDS - start))" "$step"
    return 0
  fi
  report FAILED "$((SECONDS - start))" "$step"
  tail -n 40 "$log" | sed 's/^/    /'
  return 1
}

# check <step> <command>...: a step that counts as one test.
check() {
  if run "$@"; then
    passed=$((passed + 1))
  else
    failed=$((failed + 1))
    return 1
  fi
}

# tests <step> <folder> <ctest option>...: counts each test; a run without tests is a failure.
tests() {
  local step="$1" folder="$2" junit good=yes total bad
  junit="$PWD/$logs/${1//[^A-Za-z0-9]/_}.xml"
  shift 2
  rm -f "$junit"
  run "$step" ctest --test-dir "$folder" --no-tests=error --output-on-failure -j "$jobs" \
    --output-junit "$junit" "$@" || good=no
  total="$(junit_number tests "$junit")"
  # A skipped or disabled test is one that did not show what it should.
  bad=$(($(junit_number failures "$junit") + $(junit_number skipped "$junit") + \
    $(junit_number disabled "$junit")))
  if [ "$good" = no ] && [ "$bad" -eq 0 ]; then
    bad=1
    [ "$total" -gt 0 ] || total=1
  fi
  passed=$((passed + total - bad))
  failed=$((failed + bad))
}

junit_number() { # <attribute> <file>
  local number=""
  if [ -f "$2" ]; then
    number="$(sed -n "1,20s/^.*[[:space:]]$1=\"\([0-9]*\)\".*$/\1/p" "$2" | head -n 1)"
  fi
  echo "${number:-0}"
}

# The files of the project that match a pattern.
files() {
  local pattern
  for pattern in "$@"; do
    find . -path './build*' -prune -o -type f -path "./$pattern" -print
  done
}

# configure_release <ON or OFF> <option>...: with the flags of the packages, so that these are what is
# tested and measured, and compiled once. ON leaves out the benchmarks' peers but PCL: they are not in
# the list of packages, and take minutes. What tools/test_ros.sh sets is not kept.
configure_release() {
  cmake --preset release -DSPHERICAL_PARAM_WERROR=ON -DSPHERICAL_PARAM_HARDENING=ON \
    -DBUILD_TESTING=ON -DSPHERICAL_PARAM_BUILD_TESTS=ON -DSPHERICAL_PARAM_BUILD_BENCHMARKS=ON \
    -DCMAKE_DISABLE_FIND_PACKAGE_CGAL="$1" -DCMAKE_DISABLE_FIND_PACKAGE_Open3D="$1" \
    -DSPHERICAL_PARAM_BUILD_ROS=OFF -DCMAKE_INSTALL_PREFIX=/usr/local "${@:2}"
}

# build_release [target...]: what all scripts test.
build_release() {
  configure_release ON && cmake --build build/release -j "$jobs" ${1:+--target "$@"} -- -k 0
}

# configure_and_build <preset> [target...]
configure_and_build() {
  local preset="$1"
  shift
  cmake --preset "$preset" &&
    cmake --build "build/$preset" -j "$jobs" ${1:+--target "$@"} -- -k 0
}

# doc_block <page> <n>: prints the n-th block of commands of a page that are run by this script.
doc_block() {
  awk -v wanted="$2" -v mark="<!-- run by tools/${0##*/} -->" '
    $0 == mark { ours = 1 } /^```$/ { inside = 0 } inside && block == wanted
    /^```sh$/ { inside = ours; block += ours; ours = 0 }' "$1"
}

# skip <step> <reason>: a step that cannot be made here; loud, and counted.
skip() {
  skipped=$((skipped + 1))
  report SKIP 0 "$1: $2"
}

# need_packages <name>: installs those of tools/packages-<name>.txt. Where they cannot be had, the
# script ends, with one step skipped.
need_packages() {
  local log="$logs/packages-$1.log"
  if tools/setup.sh "$1" >"$log" 2>&1; then
    use_compiler_cache
    return 0
  fi
  tail -n 5 "$log" | sed 's/^/    /'
  skip "all of $(basename "$0")" "packages of tools/packages-$1.txt cannot be had, see above"
  finish
}

# Ends the script: the last line says how many tests and other steps passed, failed, were skipped.
finish() {
  echo "$SECONDS seconds; logs are in $logs"
  echo "$passed $failed $skipped" >"$logs/$(basename "$0" .sh).counts"
  echo "$passed passed, $failed failed, $skipped skipped"
  exit $((failed > 0))
}
