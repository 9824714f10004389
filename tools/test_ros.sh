#!/usr/bin/env bash
# shellcheck disable=SC2317  # functions are called by name, by check
# The nodes of ROS: catkin, colcon and plain cmake build the same package.xml; node, nodelet,
# service and launch files of ROS 1 work with a real master; the examples of doc/guide.md are run as
# printed. Installs what it needs. The last line counts tests.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=tools/common/test_steps.sh
. tools/common/test_steps.sh
need_packages ros

# Debian's ROS is made of its own Python's modules.
export PATH="/usr/bin:$PATH"
unset ROS_VERSION ROS_PACKAGE_PATH ROS_MASTER_URI ROS_ROOT CMAKE_PREFIX_PATH AMENT_PREFIX_PATH
tree="$PWD"
# In depths as that of the other builds, so that the compiler cache knows what they compiled.
colcon_folder="$tree/build-colcon"
plain_folder="$tree/build/ros-plain"
options=(-DCMAKE_BUILD_TYPE=Release -DSPHERICAL_PARAM_WERROR=ON -DSPHERICAL_PARAM_HARDENING=ON
  -DSPHERICAL_PARAM_BUILD_TESTS=OFF -DSPHERICAL_PARAM_BUILD_TOOLS=OFF)

# What the examples of doc/guide.md have for ~, and where the first one installs.
home="$tree/build/ros-home"
installed_by_catkin="$home/ws/install_isolated"

built_by_catkin() { # as the page says
  rm -rf "$home/ws/src" "$installed_by_catkin"
  HOME="$home" bash -eo pipefail -c "$(doc_block doc/guide.md 1)"
}

# <version or ""> <folder>
built_by_colcon() {
  mkdir -p "$2"
  # Its tests need gtest of ROS; those of the package are run by tools/test.sh.
  ROS_VERSION="$1" env -C "$2" colcon --log-base log build --base-paths "$tree" --build-base . \
    --install-base install --executor sequential --event-handlers console_direct+ \
    --catkin-skip-building-tests --cmake-args -G Ninja "${options[@]}"
}

built_by_cmake() { # <folder> <option>...
  local folder="$1"
  shift
  rm -rf "$folder/install"
  cmake -G Ninja -S . -B "$folder" "${options[@]}" "$@" &&
    cmake --build "$folder" -j "$jobs" && cmake --install "$folder" --prefix "$folder/install"
}

installed() { # <prefix> <file>...
  local prefix="$1" file
  shift
  for file in "$@"; do
    [ -e "$prefix/$file" ] || {
      echo "$prefix/$file is not installed"
      return 1
    }
  done
}

not_installed() { # <prefix> <file>...
  local prefix="$1" file
  shift
  for file in "$@"; do
    [ ! -e "$prefix/$file" ] || {
      echo "$prefix/$file is installed"
      return 1
    }
  done
}

package=share/pcl_spherical_param
of_all=("$package/package.xml" lib/libpcl_spherical_param.so
  lib/cmake/pcl_spherical_param/pcl_spherical_paramConfig.cmake)
of_ros1=(lib/pcl_spherical_param/spherical_param_node lib/libspherical_param_nodelet.so
  "$package/nodelets.xml" "$package/launch/reconstruction.launch" "$package/srv/Reconstruct.srv"
  "$package/launch/depth_camera.launch" "$package/config/depth_camera.yaml"
  "$package/config/reconstruction.rviz"
  include/pcl_spherical_param/Reconstruct.h)

build_type() { # <environment> <build type> <a dependency or ""> <one that is not>
  /usr/bin/python3 - "$@" <<'EOF'
import sys
from catkin_pkg.package import parse_package
version, build_type, depend, other = sys.argv[1:]
package = parse_package('package.xml')
package.evaluate_conditions({'ROS_VERSION': version} if version else {})
names = [d.name for d in package.build_depends + package.buildtool_depends + package.exec_depends
         if d.evaluated_condition]
assert package.get_build_type() == build_type, package.get_build_type()
assert not depend or depend in names, names
assert other not in names, names
assert package.version == '0.1.0' and 'pcl_conversions' in names or not version, names
EOF
}

# What is only configured.
work="$tree/build/ros-configured"
rm -rf "$work"
mkdir -p "$work"
in_catkin=(-DCATKIN_DEVEL_PREFIX="$work/devel")

configured() { # <folder> <source> <option>...
  local folder="$1" source="$2"
  shift 2
  cmake -G Ninja -S "$source" -B "$folder" "${options[@]}" "$@"
}

nodes() { # <folder>
  grep -q 'spherical_param_node' "$1/build.ninja"
}

no_nodes() { # as configured
  configured "$@" && ! nodes "$1"
}

rejected_without_pcl() {
  local out
  ! out="$(configured "$work/rejected" "$tree" -DSPHERICAL_PARAM_BUILD_ROS=ON \
    -DSPHERICAL_PARAM_BUILD_PCL=OFF 2>&1)" && grep -q 'need PCL' <<<"$out"
}

nodes_in_workspace() {
  mkdir -p "$work/workspace/src"
  ln -s /usr/share/catkin/cmake/toplevel.cmake "$work/workspace/src/CMakeLists.txt"
  ln -s "$tree" "$work/workspace/src/pcl_spherical_param"
  ROS_VERSION=1 configured "$work/workspace/build" "$work/workspace/src" "${in_catkin[@]}" &&
    nodes "$work/workspace/build"
}

# As FetchContent has it.
no_nodes_inside_another() {
  mkdir -p "$work/other"
  cat >"$work/other/CMakeLists.txt" <<EOF
cmake_minimum_required(VERSION 3.21)
project(other LANGUAGES C CXX)
find_package(catkin REQUIRED)
catkin_package()
add_subdirectory("$tree" spherical_param)
EOF
  cat >"$work/other/package.xml" <<EOF
<package format="3">
  <name>other</name>
  <version>1.0.0</version>
  <description>Uses the library.</description>
  <maintainer email="maintainers@example.org">maintainers</maintainer>
  <license>BSD-3-Clause</license>
  <buildtool_depend>catkin</buildtool_depend>
</package>
EOF
  ROS_VERSION=1 no_nodes "$work/other/build" "$work/other" "${in_catkin[@]}"
}

# With packages that have nothing but what they tell CMake: targets as newer ones, variables as older.
node_of_ros2_is_configured() {
  local package folder names
  names="$(sed -n '/^set(ros2_packages/,/)/p' cmake/Ros.cmake | sed 's/set(ros2_packages//; s/)//')"
  for package in $names; do
    folder="$work/ros2/share/$package/cmake"
    mkdir -p "$folder" "$work/ros2/include/$package"
    if [ "$package" = rclcpp ]; then
      cat >"$folder/${package}Config.cmake" <<EOF
if(NOT TARGET $package::$package)
  add_library($package::$package INTERFACE IMPORTED)
  target_include_directories($package::$package INTERFACE "$work/ros2/include/$package")
endif()
set(${package}_TARGETS $package::$package)
EOF
    else
      echo "set(${package}_INCLUDE_DIRS \"$work/ros2/include/$package\")" \
        >"$folder/${package}Config.cmake"
    fi
  done
  ROS_VERSION=2 configured "$work/ros2/build" "$tree" -DSPHERICAL_PARAM_BUILD_ROS=ON \
    -DCMAKE_PREFIX_PATH="$work/ros2" -DCMAKE_EXPORT_COMPILE_COMMANDS=ON || return 1
  for package in $names; do
    grep '"command".*ros2/spherical_param_node.cpp' "$work/ros2/build/compile_commands.json" |
      grep -q "isystem $work/ros2/include/$package " || {
      echo "the node is compiled without $package"
      return 1
    }
  done
}

check "package.xml: ROS 1 is built by catkin" build_type 1 catkin roscpp rclcpp || true
check "package.xml: ROS 2 is built by ament" build_type 2 ament_cmake rclcpp roscpp || true
check "package.xml: without ROS cmake builds" build_type "" cmake "" sensor_msgs || true

# The schema includes another one by its address: here by its name, so that nothing is fetched.
fetch_schema() { # <name>
  [ -s "$logs/schema/$1" ] || {
    mkdir -p "$logs/schema"
    curl -fsS -m 20 -o "$logs/$1" "http://download.ros.org/schema/$1" 2>/dev/null &&
      sed 's|schemaLocation="[^"]*/\([^"/]*\)"|schemaLocation="\1"|' "$logs/$1" \
        >"$logs/schema/$1"
  }
}
if fetch_schema package_common.xsd && fetch_schema package_format3.xsd; then
  check "package.xml: its schema" xmllint --nonet --noout \
    --schema "$logs/schema/package_format3.xsd" package.xml || true
else
  skip "package.xml: its schema" "download.ros.org cannot be reached"
  check "package.xml: well formed" xmllint --noout package.xml || true
fi

if check "doc/guide.md: build by catkin" built_by_catkin; then
  check "catkin: installed" installed "$installed_by_catkin" "${of_all[@]}" \
    "${of_ros1[@]}" || true
fi
if check "colcon, ROS 1: build" built_by_colcon 1 "${colcon_folder}1"; then
  check "colcon, ROS 1: installed" installed "${colcon_folder}1/install/pcl_spherical_param" \
    "${of_all[@]}" "${of_ros1[@]}" || true
fi
if check "colcon, ROS 2: build" built_by_colcon 2 "${colcon_folder}2"; then
  check "colcon, ROS 2: installed" installed "${colcon_folder}2/install/pcl_spherical_param" \
    "${of_all[@]}" share/ament_index/resource_index/packages/pcl_spherical_param || true
fi
if [ -d /usr/share/rclcpp ]; then
  check "colcon, ROS 2: node installed" installed "${colcon_folder}2/install/pcl_spherical_param" \
    lib/pcl_spherical_param/spherical_param_node || true
else
  skip "ROS 2: node" "Debian has no rclcpp"
fi
check "ROS 2: the node gets what its packages give" node_of_ros2_is_configured || true
if check "colcon, no ROS: build" built_by_colcon "" "${colcon_folder}0"; then
  check "colcon, no ROS: installed" installed "${colcon_folder}0/install/pcl_spherical_param" \
    "${of_all[@]}" || true
fi
if check "cmake: build" built_by_cmake "$plain_folder"; then
  check "cmake: installed" installed "$plain_folder/install" "${of_all[@]}" || true
  check "cmake: nothing of ROS" not_installed "$plain_folder/install" "${of_ros1[@]}" \
    .catkin || true
fi
check "cmake with ROS 1, without PCL: rejected" rejected_without_pcl || true
check "catkin, without PCL: no nodes" no_nodes "$work/without-pcl" "$tree" \
  "${in_catkin[@]}" -DSPHERICAL_PARAM_BUILD_PCL=OFF || true
check "catkin_make: nodes in the one project of the workspace" nodes_in_workspace || true
check "catkin: no nodes inside another package" no_nodes_inside_another || true
if check "cmake with ROS 1: build" built_by_cmake "$tree/build/ros-asked" \
  -DSPHERICAL_PARAM_BUILD_ROS=ON; then
  check "cmake with ROS 1: installed" installed "$tree/build/ros-asked/install" "${of_all[@]}" \
    "${of_ros1[@]}" || true
fi

for file in src/ros/ros1/launch/*.launch src/ros/ros1/nodelets.xml; do
  check "$file: well formed" xmllint --noout "$file" || true
done
check "ROS 2: launch files" test/ros/test_ros2_launch.py || true

# Each test ends what it started; the trap is for an interruption.
test_pid=""
clean_up() {
  [ -z "$test_pid" ] || kill -TERM "$test_pid" 2>/dev/null || true
}
trap clean_up EXIT INT TERM

of_ros() ( # <name>
  set +u
  # shellcheck source=/dev/null
  . "$installed_by_catkin/setup.bash"
  set -u
  export DEPTH_CAMERA RVIZ SCANNER
  DEPTH_CAMERA="$(doc_block doc/guide.md 2)"
  RVIZ="$(doc_block doc/guide.md 3)"
  SCANNER="$(doc_block doc/guide.md 4)"
  HOME="$home" exec test/ros/test_ros1.py -j "$logs/ros1.counts"
)

ros1_tests() {
  of_ros &
  test_pid=$!
  local good=yes
  wait "$test_pid" || good=no
  test_pid=""
  [ "$good" = yes ]
}

if [ -e "$installed_by_catkin/setup.bash" ]; then
  rm -f "$logs/ros1.counts"
  good=yes
  run "ROS 1: nodes with a real master" ros1_tests || good=no
  # Tests and failures among them.
  counts=(1 1)
  [ ! -f "$logs/ros1.counts" ] || read -ra counts <"$logs/ros1.counts"
  [ "$good" = yes ] || [ "${counts[1]}" -gt 0 ] || counts[1]=1
  passed=$((passed + counts[0] - counts[1]))
  failed=$((failed + counts[1]))
fi

finish
