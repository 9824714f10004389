#!/usr/bin/env bash
# Set-up and all tests. The last line counts tests and other steps together.
#
#   tools/test.sh            everything
#   tools/test.sh --quick    gcc build, its tests and clang-format only
#
# Logs are in build/test-logs. Whatever did not change is not built or checked again.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
quick=no
case "${1:-}" in
"") ;;
--quick) quick=yes ;;
*)
  sed -n -e '2,7s/^# \{0,1\}//p' tools/test.sh
  exit 2
  ;;
esac

# shellcheck source=tools/common/test_steps.sh
. tools/common/test_steps.sh

formatted() {
  files '*.h' '*.hpp' '*.cpp' | xargs -r clang-format --dry-run --Werror
}

scripts_parse() {
  local script
  for script in $(files '*.sh' '.ci/run'); do
    bash -n "$script" || return 1
    [ -x "$script" ] || {
      echo "$script has no run bit: chmod +x $script"
      return 1
    }
  done
  while read -r script; do
    python3 -c 'import ast, sys; ast.parse(open(sys.argv[1]).read(), sys.argv[1])' "$script" ||
      return 1
  done < <(files '*.py')
}

# A file is checked again if it, a header of ours or the rules changed. The analyzer has a budget of
# paths: ten times as many take three times as long.
# shellcheck disable=SC2016  # $1 and $2 are those of the inner bash
tidy() {
  local stamps=build/clang/tidy-stamps headers source key
  mkdir -p "$stamps"
  headers="$( (cat .clang-tidy && files '*.h' | xargs cat) | sha256sum)"
  # The nodes of ROS themselves are not in the build, nor is the Python module in every one.
  for source in $(files 'src/core/*.cpp' 'src/ros/*.cpp' 'tools/*.cpp' | grep -v '^src/ros/ros'); do
    key="$( (echo "$headers $source" && cat "$source") | sha256sum | cut -d' ' -f1)"
    [ -e "$stamps/$key" ] || printf '%s\n%s\n' "$source" "$stamps/$key"
  done | xargs -r -n 2 -P "$jobs" bash -c 'clang-tidy -p build/clang --quiet --extra-arg=-Xclang \
        --extra-arg=-analyzer-config --extra-arg=-Xclang --extra-arg=max-nodes=20000 "$1" &&
        touch "$2"' _
}

check "set-up" tools/setup.sh || finish
use_compiler_cache
if check "gcc: build" build_release; then
  tests "gcc: tests" build/release
fi
check "clang-format" formatted || true
if [ "$quick" = no ]; then
  check "scripts" scripts_parse || true
  # Not built: the sanitizers' build is clang's, too.
  if check "clang: configured" cmake --preset clang; then
    check "clang-tidy" tidy || true
  fi
  export UBSAN_OPTIONS=print_stacktrace=1
  # Clang's OpenMP does not give back what it has for each thread.
  echo 'leak:libomp' >"$logs/leaks-of-others"
  export LSAN_OPTIONS="suppressions=$PWD/$logs/leaks-of-others:print_suppressions=0"
  if check "clang, ASan and UBSan: build" configure_and_build asan; then
    # Not those of results on many larger clouds: the same code runs on smaller ones in other tests.
    # Nor those of what tools do with files, one process after the other: readers and core are tested
    # here, and fuzzed by tools/torture.sh, which without --quick runs all of them.
    # The filter is for programs that are one test; others name the one of theirs that they run.
    export GTEST_FILTER='-*AttemptsAreABudget*'
    variant_tests "clang, ASan and UBSan: tests" asan build/asan \
      -E '^(Layering|Benchmark|test_shapes_are_meshed|MultilevelEmbedding.SameBits|MultilevelEmbedding.StepsDoNotGrow|test_batch_tool|test_reconstruction_tool|(HtmlReport|MorphTool|RemeshTool|TextureTool)\.)'
    unset GTEST_FILTER
  fi
  if check "TSan: build" configure_and_build tsan test_concurrency test_reconstruction_worker; then
    variant_tests "TSan: tests of concurrent use" tsan build/tsan -R '^Concurrency'
  fi
fi

finish
