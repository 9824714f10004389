#!/usr/bin/env bash
# Installations: of the release build and of static libraries, used by foreign projects; the Debian
# packages, used where they are unpacked, and installed in a bare root and used there.
#
#   tools/test_package.sh
#
# The bare root is kept in build/bare-root. Nothing is mounted.
#
# shellcheck disable=SC2317  # the functions are called by check() and run()
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=tools/common/test_steps.sh
. tools/common/test_steps.sh

packages="$PWD/build/package/packages"
work="$PWD/build/test-package"
bare="$PWD/build/bare-root/bare.tar"
root="$work/root"
as_root=()
[ "$(id -u)" -eq 0 ] || as_root=(sudo)
"${as_root[@]}" rm -rf "$work"
mkdir -p "$work" "${bare%/*}"
trap '"${as_root[@]}" rm -rf "$work"' EXIT

made() {
  cmake --preset package -DSPHERICAL_PARAM_WERROR=ON &&
    cmake --build --preset package -j "$jobs" && rm -rf "$packages" &&
    cpack --config build/package/CPackConfig.cmake &&
    [ "$(find "$packages" -maxdepth 1 -name '*.deb' | wc -l)" -eq 6 ]
}

lintian_finds_no_error() {
  # A changelog for Debian is made by who packages it for Debian.
  lintian --allow-root --fail-on error --suppress-tags no-changelog,debian-changelog-file-missing \
    "$packages"/*.deb
}

unpacked() {
  local package
  for package in "$packages"/*.deb; do
    dpkg-deb --extract "$package" "$work/unpacked" || return 1
  done
  zgrep -q threads "$work"/unpacked/usr/share/man/man1/pcl_spherical_param_reconstruction.1.gz
}

no_path_of_the_build() {
  ! grep -r --text -l -F -e "$PWD" "$work/unpacked"
}

# served <build> <components> <folder> <option>...: what is installed builds and runs foreign projects.
served() {
  local build="$1" components="$2" folder="$3"
  shift 3
  cmake -DSOURCE_DIR="$PWD" -DBUILD_DIR="$PWD/build/$build" -DWORK_DIR="$work/$folder" \
    "-DCOMPONENTS=$components" -DGENERATOR=Ninja -DCXX=c++ -DPKG_CONFIG=pkg-config \
    -DLIBDIR="$(sed -n 's/^CMAKE_INSTALL_LIBDIR:[A-Z]*=//p' "build/$build/CMakeCache.txt")" \
    -DVERSION="$(sed -n 's/^project(.* VERSION \([0-9.]*\) .*/\1/p' CMakeLists.txt)" "$@" \
    -P test/package/run_package_test.cmake
}

# Packages hold no run paths: the system's folders are searched without. Here they are elsewhere.
unpacked_serves() {
  LD_LIBRARY_PATH="$work/unpacked/usr/lib/$(dpkg-architecture -qDEB_HOST_MULTIARCH)" \
    served package "core;pcl" consumers -DPREFIX="$work/unpacked/usr"
}

# The core and the map only, because the PCL class takes long to compile.
static_core_builds() {
  cmake --preset release -B build/release-Static -DBUILD_SHARED_LIBS=OFF \
    -DSPHERICAL_PARAM_WERROR=ON -DSPHERICAL_PARAM_HARDENING=ON -DSPHERICAL_PARAM_BUILD_TESTS=OFF \
    -DSPHERICAL_PARAM_BUILD_PYTHON=OFF -DSPHERICAL_PARAM_BUILD_TOOLS=OFF &&
    cmake --build build/release-Static -j "$jobs" --target spherical_param_map
}

# As packagers give it, BUILD_TESTING wins over the project's own switch.
no_tests_without_build_testing() {
  cmake -S . -B "$work/no-tests" -G Ninja -DSPHERICAL_PARAM_BUILD_PCL=OFF \
    -DSPHERICAL_PARAM_BUILD_TOOLS=OFF -DSPHERICAL_PARAM_BUILD_PYTHON=OFF \
    -DSPHERICAL_PARAM_BUILD_TESTS=ON -DBUILD_TESTING=OFF && [ ! -e "$work/no-tests/test" ]
}

# The same release and mirror as this machine's.
bare_root() {
  local sources=() file
  for file in /etc/apt/sources.list /etc/apt/sources.list.d/debian.sources; do
    [ ! -s "$file" ] || sources+=("$file")
  done
  # What the mirror has changes from time to time.
  find "${bare%/*}" -name bare.tar -mtime +5 -delete
  [ ! -s "$bare" ] || return 0
  "${as_root[@]}" mmdebstrap --format=tar --variant=minbase \
    --skip=cleanup/apt/lists "$(. /etc/os-release && echo "$VERSION_CODENAME")" "$bare.part" \
    "${sources[@]}" &&
    "${as_root[@]}" mv "$bare.part" "$bare"
}

# All but PCL's development files, which would take minutes.
installed_and_used() {
  mkdir -p "$root" && "${as_root[@]}" tar -xf "$bare" -C "$root" --exclude=./dev/* &&
    { "${as_root[@]}" mknod -m 666 "$root/dev/null" c 1 3 || true; } &&
    "${as_root[@]}" cp "$packages"/*.deb "$root" && "${as_root[@]}" rm "$root"/libpcl*-dev_* &&
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 chroot "$root" sh -euc '
      apt-get update
      apt-get -y --no-install-recommends install /*.deb
      pcl_spherical_param_scan hand scan.ply
      pcl_spherical_param_reconstruction scan.ply mesh.ply -json report.json -report report.html
      grep -q "\"closed\": true" report.json && grep -q "\"vertices\": 5000" report.json
      python3 -c "import spherical_param"
      apt-get -y purge "*spherical-param*"
      ! ls /usr/bin /usr/lib/*/ | grep spherical'
}

check "BUILD_TESTING=OFF makes no tests" no_tests_without_build_testing || true
if check "release: build" build_release spherical_param_map pcl_spherical_param; then
  check "release: its installation serves foreign projects" \
    served release "core;core_dev;pcl;pcl_dev;license" release || true
fi
if check "static core: build" static_core_builds; then
  check "static core: its installation serves foreign projects" \
    served release-Static "core;core_dev;license" static || true
fi
need_packages package
if check "package: made" made && check "package: unpacked" unpacked; then
  check "package: lintian finds no error" lintian_finds_no_error || true
  check "package: no path of the build" no_path_of_the_build || true
  check "package: foreign projects" unpacked_serves || true
  if run "package: bare root" bare_root; then
    check "package: installed and used in the bare root" installed_and_used || true
  else
    skip "package: bare root" "mmdebstrap cannot make one here, see above"
  fi
fi
finish
