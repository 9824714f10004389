#!/usr/bin/env bash
# Measures: the paper's tables and figures, quality against truth, the peers, time and memory over
# the number of points. Installs what is missing, builds, and leaves tables, plots, pictures and
# report.md in a folder.
#
#   tools/benchmark.sh OUT [MODELS] [--quick] [--large] [--only paper|comparison|scaling|stages]
#                      [--keep] [--update-readme]
#
#   OUT              folder for the report
#   MODELS           folder of real models: points/NAME.ply and, where known, the true meshes
#                    truth/NAME.ply. Without it generated scans are all there is.
#   --quick          a minute's worth
#   --large          up to ten million points: 10 GB and some five minutes more
#   --only           one section alone; may be repeated
#   --keep           keep the clouds that were generated, in OUT/work
#   --update-readme  write the numbers that README.md quotes
set -euo pipefail

root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
build="$root/build/release"

if [ "$#" -eq 0 ] || [ "$1" = "-h" ] || [ "$1" = "--help" ]; then
  sed -n -e '2,17s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
  [ "$#" -eq 1 ] && exit 0
  exit 2
fi

suite() {
  PYTHONPATH="$root/test/benchmark" PYTHONDONTWRITEBYTECODE=1 "$@" \
    --build "$build" --readme "$root/README.md"
}
# A wrong command line is told before anything is installed or built, if Python is there already.
if [ -x /usr/bin/python3 ]; then
  suite /usr/bin/python3 -m suite "$@" --check-only
fi

"$root/tools/setup.sh" benchmark

log="$build/benchmark-build.log"
mkdir -p "$build"
echo "benchmark.sh: building in $build (minutes at first, seconds later)"
if ! (
  # tools/test.sh leaves the peers out that this wants.
  cd "$root" &&
    cmake --preset release -DSPHERICAL_PARAM_BUILD_BENCHMARKS=ON \
      -DCMAKE_DISABLE_FIND_PACKAGE_CGAL=OFF -DCMAKE_DISABLE_FIND_PACKAGE_Open3D=OFF &&
    cmake --build "$build" --target benchmark_suite
) >"$log" 2>&1; then
  tail -n 5 "$log" >&2
  echo "benchmark.sh: failed; the output of the build is in $log, remove $build to start afresh" >&2
  exit 1
fi

# A virtual display is preferred: a real one may be remote, or without OpenGL.
display=()
if command -v xvfb-run >/dev/null; then
  display=(xvfb-run -a -s "-screen 0 1280x1024x24 -noreset")
fi
suite "${display[@]}" /usr/bin/python3 -m suite "$@"
