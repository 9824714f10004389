#!/usr/bin/env bash
# The build by clang, with address and undefined behaviour sanitizers: clang-tidy, and the tests of the
# core, the map, the PCL class, the seam to ROS and the readers. What tools do with files is tested by
# tools/test.sh, and tools/stress.sh fuzzes.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=tools/common/test_steps.sh
. tools/common/test_steps.sh

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

check "set-up" tools/setup.sh || finish
use_compiler_cache
programs=(test_core test_map test_contract test_pcl test_ros_seam test_cloud_reader test_faults)
if check "clang: build" configure_and_build asan "${programs[@]}" spherical_param_tools; then
  check "clang-tidy" tidy || true
  # Large clouds, whole collections and repeated calls are for the release build: the same code runs on
  # smaller ones in other tests.
  release_only='*Large*:EveryFinding.*:Consolidation.NoiseIs*:MeshOptimization.RepairsEnd*'
  release_only+=':Contract.ThreadsAndReports*:RotationSearch.NoOther*:MeshCleaning.RandomPoints*'
  release_only+=':Judgement.WhatIsNotUsable*:SelfIntersection.ASearchUpTo*'
  for program in "${programs[@]}"; do
    check "ASan and UBSan: $program" sanitized "build/asan/bin/$program" "-$release_only" || true
  done
fi

finish
