#!/usr/bin/env bash
# Measures: the paper's tables and figures, quality against truth, other methods on the same clouds
# and scans, time and memory over the number of points. Installs missing packages, builds, and
# writes tables, plots, pictures and report.md to a folder.
#
#   tools/benchmark.sh OUT [MODELS] [--quick] [--large] [--update-doc]
#                      [--only clean|paper|comparison|views|maps|scaling|gallery]
#                      [--clean DIR]... [--clean-list FILE] [--update-clean]
#
#   OUT           folder for the report
#   MODELS        folder of real models: points/NAME.ply and, if known, the true mesh truth/NAME.ply;
#                 and of real scans, scans/NAME.ply or .pcd. Without it, generated and Debian's scans
#   --quick       small clouds, and of the other libraries PCL alone: a minute or two
#   --large       also ten million points, of a surface and airborne: 10 GB and some ten minutes more
#   --only        one section alone; may be repeated
#   --update-doc  also put the tables into README.md and doc, and the pictures into doc/gallery
#   --clean       folder of clouds, NAME.ply, .pcd or .xyz; may be repeated. Those that the list
#                 test/benchmark/clean.txt (or FILE) names must be meshed as cleanly as before
#   --update-clean  mesh all clouds of these folders, and put the clean ones into the list
set -euo pipefail

root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
build="$root/build/release"

if [ "$#" -eq 0 ] || [ "$1" = "-h" ] || [ "$1" = "--help" ]; then
  sed -n -e '2,19s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
  [ "$#" -eq 1 ] && exit 0
  exit 2
fi

# CGAL alone compiles for minutes.
packages=(peers gallery) without_peers=OFF
[[ " $* " != *" --quick "* ]] || packages=() without_peers=ON
"$root/tools/setup.sh" "${packages[@]}"

log="$build/benchmark-build.log"
mkdir -p "$build"
echo "benchmark.sh: building in $build (minutes at first, seconds later)"
if ! (
  # The same build as that of the tests, but for the peers.
  cd "$root" &&
    # shellcheck source=tools/common/test_steps.sh
    . tools/common/test_steps.sh && configure_release "$without_peers" &&
    cmake --build "$build" --target benchmark_suite
) >"$log" 2>&1; then
  tail -n 5 "$log" >&2
  echo "benchmark.sh: failed; the output of the build is in $log, remove $build to start afresh" >&2
  exit 1
fi
PYTHONPATH="$root/test/benchmark:$root/tools" PYTHONDONTWRITEBYTECODE=1 exec /usr/bin/python3 -m suite "$@" \
  --build "$build"
