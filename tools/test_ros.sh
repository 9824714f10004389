#!/usr/bin/env bash
# shellcheck disable=SC2317  # functions are called by name, by check
# The nodes of ROS: catkin, colcon and plain cmake build the same package.xml; node, nodelet,
# service and launch file of ROS 1 work with a real master; the examples of doc/guide.md are run as
# printed. Installs what it needs. The last line counts tests.
#
#   tools/test_ros.sh            everything, built as doc/guide.md says
#   tools/test_ros.sh --quick    ROS 1 with a real master, of the build of tools/test.sh; ROS 2's node compiles
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=tools/common/test_steps.sh
. tools/common/test_steps.sh
quick_option "$@"
need_packages ros

# Debian's ROS is made of its own Python's modules.
export PATH="/usr/bin:$PATH"
unset ROS_VERSION ROS_PACKAGE_PATH ROS_MASTER_URI ROS_ROOT CMAKE_PREFIX_PATH AMENT_PREFIX_PATH
tree="$PWD"
# As deep below the root as the other builds, so that the compiler cache has what they compiled.
colcon="$tree/build-colcon"
options=(-DCMAKE_BUILD_TYPE=Release -DSPHERICAL_PARAM_WERROR=ON -DSPHERICAL_PARAM_HARDENING=ON
  -DSPHERICAL_PARAM_BUILD_TESTS=OFF -DSPHERICAL_PARAM_BUILD_TOOLS=OFF)

# The home of the examples in doc/guide.md, and where the first one installs.
home="$tree/build/ros-home"
installed_by_catkin="$home/ws/install_isolated"

by_catkin() { # as the page says
  rm -rf "$home/ws/src" "$installed_by_catkin"
  HOME="$home" bash -eo pipefail -c "$(doc_block doc/guide.md 1)"
}

of_tests() { # the build of tools/test.sh, where the examples look for that of catkin
  rm -rf "$installed_by_catkin"
  # catkin's setup files go where the prefix was when it was configured.
  configure_release ON -DSPHERICAL_PARAM_BUILD_ROS=ON -DCMAKE_INSTALL_PREFIX="$installed_by_catkin" &&
    cmake --build build/release -j "$jobs" && cmake --install build/release >/dev/null
}

by_colcon() { # <version or ""> <folder>
  mkdir -p "$2"
  # Its tests need gtest of ROS; those of the package are run by tools/test.sh.
  ROS_VERSION="$1" env -C "$2" colcon --log-base log build --base-paths "$tree" --build-base . \
    --install-base install --executor sequential --event-handlers console_direct+ \
    --catkin-skip-building-tests --cmake-args -G Ninja "${options[@]}"
}

by_cmake() { # <folder> <option>...
  rm -rf "$1/install"
  configured "$1" "$tree" "${@:2}" && cmake --build "$1" -j "$jobs" &&
    cmake --install "$1" --prefix "$1/install"
}

holds() { # <prefix> <file, or ! and one that it must not hold>...
  local file wrong=()
  for file in "${@:2}"; do
    case "$file" in
      !*) [ ! -e "$1/${file#!}" ] ;;
      *) [ -e "$1/$file" ] ;;
    esac || wrong+=("$file")
  done
  [ "${#wrong[@]}" -eq 0 ] || { printf '%s\n' "$1:" "${wrong[@]}"; return 1; }
}

package=share/pcl_spherical_param
of_all=("$package/package.xml" lib/libpcl_spherical_param.so
  lib/cmake/pcl_spherical_param/pcl_spherical_paramConfig.cmake)
of_ros1=(lib/pcl_spherical_param/spherical_param_node lib/libspherical_param_nodelet.so
  "$package/nodelets.xml" "$package/launch/reconstruction.launch" "$package/srv/Reconstruct.srv"
  "$package/config/depth_camera.yaml" "$package/config/reconstruction.rviz"
  include/pcl_spherical_param/Reconstruct.h)
of_ros2=(share/ament_index/resource_index/packages/pcl_spherical_param)

package_xml_fits_each_ros() {
  /usr/bin/python3 - <<'END'
from catkin_pkg.package import parse_package
for version, build_type, depend, other in (('1', 'catkin', 'roscpp', 'rclcpp'), ('2', 'ament_cmake', 'rclcpp', 'roscpp'),
                                           (None, 'cmake', None, 'sensor_msgs')):
    package = parse_package('package.xml')
    package.evaluate_conditions({'ROS_VERSION': version} if version else {})
    names = {each.name for each in package.build_depends + package.buildtool_depends + package.exec_depends
             if each.evaluated_condition}
    assert package.get_build_type() == build_type, package.get_build_type()
    assert not version or {depend, 'pcl_conversions'} <= names, names
    assert other not in names, names
END
}

# Builds that are only configured.
work="$tree/build/ros-configured"
rm -rf "$work"
mkdir -p "$work"
in_catkin=(-DCATKIN_DEVEL_PREFIX="$work/devel")

configured() { # <folder> <source> <option>...
  cmake -G Ninja -S "$2" -B "$1" "${options[@]}" "${@:3}"
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
  sed -e '/<depend/d; /<exec/d; /<export/,/<\/export/d; s/pcl_spherical_param/other/' package.xml \
    >"$work/other/package.xml"
  cat >"$work/other/CMakeLists.txt" <<END
cmake_minimum_required(VERSION 3.21)
project(other LANGUAGES C CXX)
find_package(catkin REQUIRED)
catkin_package()
add_subdirectory("$tree" spherical_param)
END
  ROS_VERSION=1 no_nodes "$work/other/build" "$work/other" "${in_catkin[@]}"
}

# With the declarations that it uses, in a folder for each package. One gives a target, as newer packages do, the others
# give variables.
node_of_ros2_compiles() {
  local name folder stubs="$tree/test/ros/ros2_stubs"
  for name in $(sed -n '/^set(ros2_packages/,/)/p' cmake/Ros.cmake | sed 's/set(ros2_packages//; s/)//'); do
    folder="$work/ros2/share/$name/cmake"
    mkdir -p "$folder"
    echo "set(${name}_INCLUDE_DIRS \"$stubs/$name\")" >"$folder/${name}Config.cmake"
  done
  cat >"$work/ros2/share/rclcpp/cmake/rclcppConfig.cmake" <<END
if(NOT TARGET rclcpp::rclcpp)
  add_library(rclcpp::rclcpp INTERFACE IMPORTED)
  target_include_directories(rclcpp::rclcpp INTERFACE "$stubs/rclcpp")
endif()
set(rclcpp_TARGETS rclcpp::rclcpp)
END
  ROS_VERSION=2 configured "$work/ros2/build" "$tree" -DSPHERICAL_PARAM_BUILD_ROS=ON \
    -DCMAKE_PREFIX_PATH="$work/ros2" && cmake --build "$work/ros2/build" \
    --target CMakeFiles/spherical_param_node.dir/src/ros/ros2/spherical_param_node.cpp.o
}

# built <how> <prefix> <command>...: with the files in `files`.
built() {
  if check "$1: build" "${@:3}"; then
    check "$1: installed" holds "$2" "${files[@]}" || true
  fi
}

ros1_tests() (
  set +u
  # shellcheck source=/dev/null
  . "$installed_by_catkin/setup.bash"
  export DEPTH_CAMERA RVIZ SCANNER
  DEPTH_CAMERA="$(doc_block doc/guide.md 2)"
  RVIZ="$(doc_block doc/guide.md 3)"
  SCANNER="$(doc_block doc/guide.md 4)"
  HOME="$home" exec test/ros/test_ros1.py
)

check "ROS 2: node compiles, with declarations of its packages" node_of_ros2_compiles || true
check "ROS 2: launch file" test/ros/test_ros2_launch.py || true

if [ "$quick" = yes ]; then
  files=("${of_all[@]}" "${of_ros1[@]}")
  built "ROS 1, of the tests" "$installed_by_catkin" of_tests
  check "ROS 1: nodes with a real master" ros1_tests || true
  finish
fi

check "package.xml: build type and dependencies fit each ROS" package_xml_fits_each_ros || true
files=("${of_all[@]}" "${of_ros1[@]}")
built "catkin, by doc/guide.md" "$installed_by_catkin" by_catkin
built "colcon, ROS 1" "${colcon}1/install/pcl_spherical_param" by_colcon 1 "${colcon}1"
built "cmake with ROS 1" "$tree/build/ros-asked/install" by_cmake "$tree/build/ros-asked" \
  -DSPHERICAL_PARAM_BUILD_ROS=ON
files=("${of_all[@]}" "${of_ros2[@]}")
built "colcon, ROS 2" "${colcon}2/install/pcl_spherical_param" by_colcon 2 "${colcon}2"
files=("${of_all[@]}" "${of_ros1[@]/#/!}" '!.catkin')
built "colcon, no ROS" "${colcon}0/install/pcl_spherical_param" by_colcon "" "${colcon}0"
check "cmake with ROS 1, without PCL: rejected" rejected_without_pcl || true
check "catkin, without PCL: no nodes" no_nodes "$work/without-pcl" "$tree" \
  "${in_catkin[@]}" -DSPHERICAL_PARAM_BUILD_PCL=OFF || true
check "catkin_make: nodes in the one project of the workspace" nodes_in_workspace || true
check "catkin: no nodes inside another package" no_nodes_inside_another || true
check "ROS 1: nodes with a real master" ros1_tests || true

finish
