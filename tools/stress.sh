#!/usr/bin/env bash
# Fuzzes the calls of the library, and the files that the tools read.
#
#   tools/stress.sh            everything: hours
#   tools/stress.sh --quick    minutes, which tools/test_all.sh runs
#
# Logs, and inputs that break a fuzzer, are in build/stress.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=tools/common/test_steps.sh
. tools/common/test_steps.sh
quick_option "$@"
# Seconds of each fuzzer; seed 0: another one each time.
seconds=600 seed=0
[ "$quick" = no ] || seconds=10 seed=1

work="$PWD/build/stress"
rm -rf "$work"
mkdir -p "$work"

# fuzz <corpus>: on a copy of the corpus, whose folder has the name of its fuzzer.
fuzz() {
  local name="${1##*/}" log
  log="$work/$name.log"
  mkdir -p "$work/$name" "$work/$name-tmp"
  cp "$1"/* "$work/$name"
  TMPDIR="$work/$name-tmp" "build/asan/bin/fuzz_$name" -seed="$seed" -max_total_time="$seconds" \
    -timeout=60 -rss_limit_mb=2048 -max_len=4096 -print_final_stats=1 \
    -artifact_prefix="$work/$name-" "$work/$name" 2>&1 | tee "$log" &&
    grep -q '^stat::number_of_executed_units: *[1-9]' "$log"
}

if check "fuzzers: build" configure_and_build asan fuzzers; then
  for corpus in test/fuzz/corpus/*; do
    check "fuzz_${corpus##*/}" fuzz "$corpus" || true
  done
fi
finish
