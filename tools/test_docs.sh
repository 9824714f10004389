#!/usr/bin/env bash
# The documentation: the site builds without a warning, all links lead somewhere, the demo leaves what
# it says, and the marked examples of the pages run as printed with an installation of the release build.
#
#   tools/test_docs.sh
#
# Logs are in build/test-logs.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
if [ "$#" -ne 0 ]; then
  sed -n -e '2,7s/^# \{0,1\}//p' tools/test_docs.sh
  exit 2
fi

# shellcheck source=tools/common/test_steps.sh
. tools/common/test_steps.sh

prefix="$PWD/build/docs/prefix"

# shellcheck disable=SC2317  # called by name, by check
install_build() {
  rm -rf "$prefix"
  cmake --install build/release --prefix "$prefix"
}

# shellcheck disable=SC2317  # called by name, by check
demo() {
  local file
  rm -rf build/demo
  tools/demo.sh build/demo || return 1
  for file in scan.ply mesh.ply sphere.ply report.json demo.png; do
    [ -s "build/demo/$file" ] || {
      echo "build/demo/$file is missing or empty"
      return 1
    }
  done
}

need_packages docs
check "links" doc/check_links.py . || true
if check "build" build_release; then
  check "demo" demo || true
  check "site: built without warnings" cmake --build build/release --target doc || true
  if check "installation" install_build; then
    for page in README.md doc/*.md; do
      if grep -q '^<!-- test' "$page"; then
        check "examples of $page" test/doc/run_examples.py "$prefix" build/release/python "$page" ||
          true
      fi
    done
  fi
fi

finish
