#!/usr/bin/env bash
# Set-up and tests: the build by gcc with all of its tests, clang-format, and the syntax of the scripts. The last line
# counts tests and other steps together.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=tools/common/test_steps.sh
. tools/common/test_steps.sh
[ $# -eq 0 ] || usage

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
check "scripts" scripts_parse || true
finish
