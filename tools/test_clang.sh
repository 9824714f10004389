#!/usr/bin/env bash
# The build by clang, with address and undefined behaviour sanitizers, and its tests. What tools do with files is tested
# by tools/test.sh, and tools/stress.sh fuzzes.
#
#   tools/test_clang.sh            core, map, PCL class, the seam to ROS and the readers; clang-tidy, the thread
#                                  sanitizer on the tests of concurrency, a build with libc++
#   tools/test_clang.sh --quick    the quick tests of core and map
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=tools/common/test_steps.sh
. tools/common/test_steps.sh
quick_option "$@"

# Large clouds, whole collections and repeated calls are for the release build: the same code runs on smaller ones in
# other tests.
release_only='*Large*:EveryFinding.*:Consolidation.NoiseIs*:MeshOptimization.RepairsEnd*'
release_only+=':Contract.ThreadsAndReports*:RotationSearch.NoOther*:MeshCleaning.RandomPoints*'
release_only+=':Judgement.WhatIsNotUsable*:SelfIntersection.ASearchUpTo*'
# Some of the others, which take half of their time.
slow='Contract.*Report*:Reconstruct.NastySets*:Concurrency.*:Reconstruct.Mirrored*:Contract.SurfacesDoNotDepend*'
slow+=':Selection.EverySurface*'

# The sources of library and tools as the clang build compiles them: several together, so that the
# headers of others are read once for all. So the analyzer must look into included files, too. It has
# a budget of paths: ten times as many take three times as long. The line that counts warnings in other
# people's headers is left out, so that the end of the log shows the errors.
tidy() {
  sed -n 's/^ *"file": "\(.*\)",\{0,1\}$/\1/p' build/asan/compile_commands.json |
    grep -v -e "^$PWD/test/" -e '/build/asan/test/' -e '/cmake_pch' |
    xargs -n 1 -P "$jobs" clang-tidy -p build/asan --quiet --checks=-bugprone-suspicious-include \
      --extra-arg=-Xclang --extra-arg=-analyzer-opt-analyze-headers --extra-arg=-Xclang \
      --extra-arg=-analyzer-config --extra-arg=-Xclang --extra-arg=max-nodes=20000 2>&1 |
    sed '/ warnings* generated\.$/d'
}

# sanitized <program> <filter>: tests of a program, in parts that keep all processors busy.
sanitized() {
  local parts="$((4 * jobs))"
  seq 0 "$((parts - 1))" | xargs -P "$jobs" -I '{}' env GTEST_TOTAL_SHARDS="$parts" \
    GTEST_SHARD_INDEX='{}' "$1" --gtest_brief=1 "--gtest_filter=$2"
}

build_libcxx() {
  cmake -G Ninja -S . -B build/libcxx -DCMAKE_BUILD_TYPE=Release -DCMAKE_C_COMPILER=clang \
    -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_CXX_FLAGS=-stdlib=libc++ -DSPHERICAL_PARAM_WERROR=ON \
    -DSPHERICAL_PARAM_BUILD_PCL=OFF -DSPHERICAL_PARAM_BUILD_PYTHON=OFF &&
    cmake --build build/libcxx -j "$jobs"
}

# Another compiler and another standard library make the same mesh.
same_mesh_with_libcxx() {
  local build
  build_release pcl_spherical_param_scan pcl_spherical_param_reconstruction || return 1
  for build in release libcxx; do
    "build/$build/bin/pcl_spherical_param_scan" animal "build/$build/views.ply" -views 3 -noise 1 -points 2000 &&
      "build/$build/bin/pcl_spherical_param_scan" hand "build/$build/scan.ply" -points 5000 &&
      "build/$build/bin/pcl_spherical_param_reconstruction" "build/$build/scan.ply" "build/$build/mesh.ply" ||
      return 1
  done
  cmp build/{release,libcxx}/views.ply && cmp build/{release,libcxx}/scan.ply && cmp build/{release,libcxx}/mesh.ply
}

check "set-up" tools/setup.sh || finish
use_compiler_cache
programs=(test_core test_map test_contract)
targets=("${programs[@]}")
left_out="$release_only:$slow"
if [ "$quick" = no ]; then
  programs+=(test_pcl test_ros_seam test_cloud_reader test_faults)
  targets=("${programs[@]}" spherical_param_tools)
  left_out="$release_only"
fi
if check "clang: build" configure_and_build asan "${targets[@]}"; then
  [ "$quick" = yes ] || check "clang-tidy" tidy || true
  for program in "${programs[@]}"; do
    check "ASan and UBSan: $program" sanitized "build/asan/bin/$program" "-$left_out" || true
  done
fi
[ "$quick" = no ] || finish

programs=(test_contract test_reconstruction_worker)
if check "TSan: build" configure_and_build tsan "${programs[@]}"; then
  for program in "${programs[@]}"; do
    check "TSan: $program" "build/tsan/bin/$program" --gtest_brief=1 '--gtest_filter=Concurrency*' || true
  done
fi
if ! run "libc++: packages" tools/setup.sh clang; then
  skip "libc++" "packages of tools/packages-clang.txt cannot be had"
elif check "libc++: build" build_libcxx; then
  check "libc++: the same mesh" same_mesh_with_libcxx || true
fi
finish
