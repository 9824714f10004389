#!/usr/bin/env bash
# shellcheck disable=SC2317  # functions are called by name, by check
# The documentation: its site is built without a warning, all links within it and the tree lead
# somewhere, and the programs and commands that it shows work with an installation of the release
# build.
#
#   tools/test_docs.sh
#
# Logs are in build/test-logs.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
if [ "$#" -ne 0 ]; then
  sed -n -e '3,9s/^# \{0,1\}//p' tools/test_docs.sh
  exit 2
fi

# shellcheck source=tools/common/test_steps.sh
. tools/common/test_steps.sh

root="$PWD"
work="$root/build/docs"
prefix="$work/prefix"

install_build() {
  rm -rf "$prefix"
  cmake --install build/release --prefix "$prefix"
}

build_example() { # <folder of doc/tutorials>
  cmake -G Ninja -S "doc/tutorials/$1" -B "$work/$1" -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_PREFIX_PATH="$prefix" &&
    cmake --build "$work/$1" -j "$jobs"
}

# in_folder <name> <command>...: runs it in an empty folder, with the installed tools on the PATH.
in_folder() {
  local folder="$work/run/$1"
  shift
  rm -rf "$folder"
  mkdir -p "$folder"
  (
    cd "$folder"
    PATH="$prefix/bin:$root/doc/tutorials/raw_scan:$PATH"
    "$@"
  )
}

page_commands() { # <page> <mark>: runs its commands, each of which has to succeed
  "$root/doc/page_commands.py" "$root/doc/$1" "$2" >commands.sh && bash -euxo pipefail commands.sh
}

are_written() {
  local file
  for file in "$@"; do
    [ -s "$file" ] || {
      echo "$file was not written"
      return 1
    }
  done
}

tutorial_program() {
  page_commands tutorials/raw_scan/README.md scan &&
    "$work/raw_scan/raw_scan" scan.ply >output.txt &&
    cat output.txt &&
    grep -qx '20100 points' output.txt &&
    grep -q ' triangles, 0 self-intersections$' output.txt &&
    grep -q ' on average, 0 self-intersections$' output.txt &&
    are_written mesh.ply smooth.ply model.obj model.mtl model.png
}

tutorial_tools() {
  page_commands tutorials/raw_scan/README.md scan &&
    page_commands tutorials/raw_scan/README.md tools &&
    are_written mesh.ply smooth.ply report.json model.glb model.obj model.png &&
    python3 - <<'END'
import json

report = json.load(open("report.json"))
assert report["smoothing"]["self_intersections"] == 0, report["smoothing"]
assert report["diagnosis"]["looks_closed_genus0"], report["diagnosis"]
END
}

tool_page() { # <tool>
  pcl_spherical_param_scan hand scan.ply -points 4000 &&
    pcl_spherical_param_scan head first.ply -points 2000 &&
    pcl_spherical_param_scan animal second.ply -points 2000 &&
    page_commands "tools/$1.md" commands
}

# Either program meshes a clean scan; ours says that nothing is wrong with it.
migration() {
  pcl_spherical_param_scan hand scan.ply -points 10000 &&
    "$work/migration/before" scan.ply before.ply &&
    "$work/migration/after" scan.ply after.ply >output.txt &&
    cat output.txt &&
    grep -qx '19996 triangles, 0 self-intersections' output.txt &&
    are_written before.ply after.ply
}

need_packages docs
mkdir -p "$work"
if check "build" build_release; then
  check "site: built without warnings" cmake --build build/release --target doc || true
  check "links of the sources and of the site" doc/check_links.py --tools build/release/bin \
    --site build/release/doc/html --external || true
  if check "installation" install_build; then
    for tool in reconstruction texture remesh morph scan; do
      check "commands of doc/tools/$tool.md" in_folder "$tool" tool_page "$tool" || true
    done
    check "tutorial: commands" in_folder tutorial_tools tutorial_tools || true
    if check "tutorial: build" build_example raw_scan; then
      check "tutorial: program" in_folder tutorial_program tutorial_program || true
    fi
    if check "migration: build" build_example migration; then
      check "migration: programs" in_folder migration migration || true
    fi
  fi
fi

finish
