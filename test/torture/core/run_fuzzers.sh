#!/usr/bin/env bash
# Fuzzes the core on a copy of the corpus that is kept, all fuzzers at once, a core each.
#
#   run_fuzzers.sh FOLDER WORK [--quick] [--seed N]
#
# FOLDER holds the programs, WORK takes what is new. 15 minutes each; with --quick 30 seconds.
set -euo pipefail

here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
programs="$1"
work="$2"
shift 2
seconds=900
seed=0 # another one each time, which the log tells; with --quick 1
while [ $# -gt 0 ]; do
  case "$1" in
  --quick)
    seconds=30
    seed=1
    ;;
  --seed)
    seed="$2"
    shift
    ;;
  *)
    sed -n -e '2,6s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
    exit 2
    ;;
  esac
  shift
done

# Ten seconds would be a hang; the rest is for machines that are busy with other things.
fuzz() { # <name>
  local corpus="$work/$1"
  mkdir -p "$corpus"
  cp "$here/corpus/$1/"* "$corpus"
  "$programs/fuzz_$1" -seed="$seed" -max_total_time="$seconds" -timeout=60 -rss_limit_mb=1024 \
    -max_len=1024 -print_final_stats=1 -artifact_prefix="$work/$1-" "$corpus" >"$work/$1.log" 2>&1
}

names=(reconstruct stages)
pids=()
for name in "${names[@]}"; do
  fuzz "$name" &
  pids+=($!)
done
bad=0
for i in "${!names[@]}"; do
  name="${names[$i]}"
  found=0
  wait "${pids[$i]}" || found=1
  log="$work/$name.log"
  tried="$(sed -n 's/^stat::number_of_executed_units: *//p' "$log" | tail -n 1)"
  covered="$(sed -n 's/^#.* cov: \([0-9]*\) .*$/\1/p' "$log" | tail -n 1)"
  # Without its last words, or with nothing tried, it did not fuzz.
  [ "${tried:-0}" -gt 0 ] || found=1
  if [ "$found" -ne 0 ]; then
    tail -n 40 "$log"
    bad=1
  fi
  grep -h '^INFO: Seed:' "$log" | sed "s/^/fuzz_$name: /" || true
  echo "row: core | fuzz_$name, $seconds s, ASan and UBSan, ${covered:-0} places reached |" \
    "${tried:-0} | 0 | $found | 0"
done
exit "$bad"
