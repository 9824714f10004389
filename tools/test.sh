#!/usr/bin/env bash
# Set-up and all tests. The last line is "N passed, N failed": tests and other steps together.
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

# Nothing here asks questions; a tool that tried to must not hang.
exec </dev/null
jobs="$(nproc)"
logs=build/test-logs
mkdir -p "$logs"
passed=0
failed=0

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

# variant_tests <step> <preset> <folder> <ctest option>...: as tests(), of a build that differs from
# the first one by its compiler's settings only. Not run again if all passed and no program, library
# or file of the tests changed since.
variant_tests() {
  local step="$1" preset="$2" folder="$3" stamp key count
  shift 3
  stamp="build/$preset/tests-passed"
  key="$( (
    echo "$@"
    find "build/$preset" -type f \( -path '*/bin/*' -o -name '*.so*' \) -print0 | sort -z |
      xargs -0 sha256sum
    files 'test/*' 'cmake/*' | xargs sha256sum
  ) | sha256sum | cut -d' ' -f1)"
  if [ -f "$stamp" ] && read -r count <"$stamp" && [ "${count#"$key "}" != "$count" ]; then
    count="${count#"$key "}"
    passed=$((passed + count))
    report ok 0 "$step ($count, unchanged)"
    return 0
  fi
  rm -f "$stamp"
  local failed_before="$failed" passed_before="$passed"
  tests "$step" "$folder" "$@"
  if [ "$failed" -eq "$failed_before" ]; then
    echo "$key $((passed - passed_before))" >"$stamp"
  fi
}

junit_number() { # <attribute> <file>
  local number=""
  if [ -f "$2" ]; then
    number="$(sed -n "1,20s/^.*[[:space:]]$1=\"\([0-9]*\)\".*$/\1/p" "$2" | head -n 1)"
  fi
  echo "${number:-0}"
}

# The files of the project that match a pattern, with or without git.
files() {
  if git rev-parse --is-inside-work-tree >/dev/null 2>&1; then
    git ls-files -co --exclude-standard -- "$@" | while read -r file; do
      [ ! -e "$file" ] || printf '%s\n' "$file"
    done
  else
    local pattern
    for pattern in "$@"; do
      find . -path ./build -prune -o -type f -path "./$pattern" -print | sed 's|^\./||'
    done
  fi | sort -u
}

configure_and_build() { # <preset> <targets or ""> <cmake option>...
  local preset="$1" target="$2"
  shift 2
  cmake --preset "$preset" "$@" &&
    cmake --build "build/$preset" -j "$jobs" ${target:+--target "$target"} -- -k 0
}

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

# A file is checked again if it, a header of ours or the rules changed.
# shellcheck disable=SC2016  # $1 and $2 are those of the inner bash
tidy() {
  local stamps=build/clang/tidy-stamps headers source key
  mkdir -p "$stamps"
  headers="$( (cat .clang-tidy && files '*.h' | xargs cat) | sha256sum)"
  for source in $(files 'src/core/*.cpp' 'tools/*.cpp'); do
    key="$( (echo "$headers $source" && cat "$source") | sha256sum | cut -d' ' -f1)"
    [ -e "$stamps/$key" ] || printf '%s\n%s\n' "$source" "$stamps/$key"
  done | xargs -r -n 2 -P "$jobs" bash -c 'clang-tidy -p build/clang --quiet "$1" && touch "$2"' _
}

check "set-up" tools/setup.sh || {
  echo "$passed passed, $failed failed"
  exit 1
}
# Of the benchmarks' peers only PCL: the others are not in the list of packages, and take minutes.
if check "gcc: build" configure_and_build release "" -DSPHERICAL_PARAM_WERROR=ON \
  -DSPHERICAL_PARAM_BUILD_BENCHMARKS=ON -DCMAKE_DISABLE_FIND_PACKAGE_CGAL=ON \
  -DCMAKE_DISABLE_FIND_PACKAGE_Open3D=ON; then
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
  if check "clang, ASan and UBSan: build" configure_and_build asan ""; then
    # Not those of results on many larger clouds: the same code runs on smaller ones in other tests.
    # The filter is for programs that are one test; others name the one of theirs that they run.
    export GTEST_FILTER='-*AttemptsAreABudget*:ReconstructionTool.SameBytesForAnyNumberOfThreads'
    variant_tests "clang, ASan and UBSan: tests" asan build/asan \
      -E '^(Layering|Benchmark|test_shapes_are_meshed|MultilevelEmbedding.SameBits|MultilevelEmbedding.StepsDoNotGrow)'
    unset GTEST_FILTER
  fi
  if check "TSan: build" configure_and_build tsan test_concurrency; then
    variant_tests "TSan: tests of concurrent use" tsan build/tsan/test/core -R '^Concurrency'
  fi
fi

echo "$SECONDS seconds; logs are in $logs"
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
