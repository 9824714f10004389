#!/usr/bin/env bash
# Set-up and tests. The last line counts tests and other steps together.
#
#   tools/test.sh            gcc build and its tests, formats, scripts, thread sanitizer
#   tools/test.sh --quick    gcc build, its tests and clang-format only
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
case "${1:-}" in
"") quick=no ;;
--quick) quick=yes ;;
*)
  sed -n -e '2,5s/^# \{0,1\}//p' tools/test.sh
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
  files '*.py' | xargs python3 -c 'import ast, sys
for script in sys.argv[1:]:
    ast.parse(open(script).read(), script)'
}

check "set-up" tools/setup.sh || finish
use_compiler_cache
if check "gcc: build" build_release; then
  tests "gcc: tests" build/release
fi
check "clang-format" formatted || true
if [ "$quick" = no ]; then
  check "scripts" scripts_parse || true
  programs=(test_contract test_reconstruction_worker)
  if check "TSan: build" configure_and_build tsan "${programs[@]}"; then
    for program in "${programs[@]}"; do
      check "TSan: $program" "build/tsan/bin/$program" --gtest_brief=1 \
        '--gtest_filter=Concurrency*' || true
    done
  fi
fi

finish
