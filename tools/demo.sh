#!/usr/bin/env bash
# The whole way on a bare Debian 12: installs what is missing, builds the tools, takes a depth image
# of a generated desk, and meshes it. Leaves the mesh, and a page to look at.
#
#   tools/demo.sh [OUTPUT_FOLDER]      default: demo_output in the checkout
set -euo pipefail

root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
build="$root/build/demo"

# What to do if the step that is under way fails.
remedy=""
trap '[ -z "$remedy" ] || printf "demo.sh: failed; %s\n" "$remedy" >&2' ERR

if [ "$#" -gt 1 ] || [ "${1:-}" = "-h" ] || [ "${1:-}" = "--help" ]; then
  sed -n -e '2,5s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
  [ "$#" -eq 1 ] && exit 0
  exit 2
fi
remedy="give an output folder that can be written: tools/demo.sh FOLDER"
out="${1:-$root/demo_output}"
mkdir -p "$out"
[ -w "$out" ]

remedy="see above; tools/packages.txt lists what is needed"
"$root/tools/setup.sh" --demo

log="$build/build.log"
mkdir -p "$build"
remedy="the output of the build is in $log; remove $build to start afresh"
echo "demo.sh: building in $build (a minute or two at first, seconds later)"
(
  cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DBUILD_TESTING=OFF \
    -DSPHERICAL_PARAM_BUILD_PCL=OFF -DSPHERICAL_PARAM_BUILD_PYTHON=OFF
  cmake --build "$build" --target pcl_spherical_param_scan pcl_spherical_param_reconstruction
) >"$log" 2>&1

remedy="the message above says why; the tools are in $build/bin"
"$build/bin/pcl_spherical_param_scan" desk "$out/scan.ply"
"$build/bin/pcl_spherical_param_reconstruction" "$out/scan.ply" "$out/mesh.ply" \
  -report "$out/report.html"

echo
printf '%-8s %s\n' scan "$out/scan.ply" mesh "$out/mesh.ply" report "$out/report.html"
