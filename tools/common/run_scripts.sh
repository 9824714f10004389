#!/usr/bin/env bash
# Runs scripts of the folder tools one after the other. The last line is the sum of their tests and other steps.
#
#   tools/common/run_scripts.sh "NAME [OPTION]"...     e.g. test "test_clang --quick"
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

good=yes
total=(0 0 0)
for call in "$@"; do
  read -ra words <<<"$call"
  echo "== tools/${words[0]}.sh ${words[*]:1}"
  counts_file="build/test-logs/${words[0]}.counts"
  rm -f "$counts_file"
  "tools/${words[0]}.sh" "${words[@]:1}" || good=no
  counts=(0 1 0) # of a script that did not come to its end
  [ ! -f "$counts_file" ] || read -ra counts <"$counts_file"
  for i in 0 1 2; do
    total[i]=$((total[i] + counts[i]))
  done
done
echo "== $SECONDS seconds"
echo "${total[0]} passed, ${total[1]} failed, ${total[2]} skipped"
[ "$good" = yes ]
