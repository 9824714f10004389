#!/usr/bin/env bash
# The documentation: the site builds without a warning, all links lead somewhere, the demo leaves what
# it says, and the marked examples of the pages run as printed with an installation of the release build.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=tools/common/test_steps.sh
. tools/common/test_steps.sh

clone="$PWD/build/docs/clone"
prefix="$PWD/build/docs/root/usr/local"

# as_printed <commands>: of a page, in a clone, into a root of its own.
as_printed() {
  (cd "$clone" && DESTDIR="$PWD/../root" CMAKE_BUILD_PARALLEL_LEVEL="$jobs" bash -euc "$1")
}

cloned() {
  rm -rf build/docs
  mkdir -p build/docs
  git clone -q . "$clone"
}

demo() {
  local file
  as_printed "$(doc_block README.md 1)" || return 1
  for file in scan.ply mesh.ply report.html; do
    [ -s "$clone/demo_output/$file" ] || {
      echo "$file is missing or empty"
      return 1
    }
  done
}

installed() {
  as_printed "$(doc_block README.md 2)" &&
    [ -x "$prefix/bin/pcl_spherical_param_reconstruction" ]
}

# The program of README's example, without CMake.
compiled_by_pkg_config() {
  sed -n '/^```cpp$/,/^```$/p' README.md | sed '/^```/d' >build/docs/main.cpp
  (cd build/docs && PKG_CONFIG_PATH="$prefix/lib/pkgconfig" bash -euc "$(doc_block ../../doc/guide.md 1)")
}

need_packages docs
check "links" doc/check_links.py . || true
if check "build" build_release && check "clone" cloned; then
  if check "site: built without warnings" cmake --build build/release --target doc; then
    check "site: can be searched" grep -q "'Guide'" build/release/doc/html/search/pages_*.js || true
  fi
  check "demo" demo || true
  if check "installation" installed; then
    check "compiled by pkg-config" compiled_by_pkg_config || true
    for page in README.md doc/guide.md; do
      check "examples of $page" test/doc/run_examples.py "$prefix" build/release/python "$page" ||
        true
    done
  fi
fi

finish
