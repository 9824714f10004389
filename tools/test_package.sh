#!/usr/bin/env bash
# The Debian packages: made, used where they are unpacked, and installed in a bare root and used there.
# A static core, installed, moved and used by a foreign project.
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
need_packages package

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
  rm -rf "$packages" && CMAKE_BUILD_PARALLEL_LEVEL="$jobs" bash -euc "$(doc_block doc/guide.md 1)" &&
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

# used_by_foreign_projects <option of run_package_test.cmake>...
used_by_foreign_projects() {
  cmake -DSOURCE_DIR="$PWD" -DWORK_DIR="$work/consumers" -DGENERATOR=Ninja -DCXX=c++ \
    -DPKG_CONFIG=pkg-config \
    -DVERSION="$(sed -n 's/^project(.* VERSION \([0-9.]*\) .*/\1/p' CMakeLists.txt)" "$@" \
    -P test/package/run_package_test.cmake
}

# Packages hold no run paths: the system's folders are searched without. Here they are elsewhere.
foreign_projects() {
  local lib
  lib="lib/$(dpkg-architecture -qDEB_HOST_MULTIARCH)"
  LD_LIBRARY_PATH="$work/unpacked/usr/$lib" used_by_foreign_projects -DBUILD_DIR="$PWD/build/package" \
    -DPREFIX="$work/unpacked/usr" "-DCOMPONENTS=core;pcl" -DLIBDIR="$lib"
}

# BUILD_TESTING=OFF, as packagers give it, wins over the project's own switch.
static_core() {
  local folder="$PWD/build/static"
  cmake -G Ninja -S . -B "$folder" -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=OFF \
    -DSPHERICAL_PARAM_BUILD_PCL=OFF -DSPHERICAL_PARAM_BUILD_TOOLS=OFF \
    -DSPHERICAL_PARAM_BUILD_PYTHON=OFF -DSPHERICAL_PARAM_WERROR=ON -DSPHERICAL_PARAM_HARDENING=ON \
    -DSPHERICAL_PARAM_BUILD_TESTS=ON -DBUILD_TESTING=OFF && [ ! -e "$folder/test" ] &&
    cmake --build "$folder" -j "$jobs" &&
    used_by_foreign_projects -DBUILD_DIR="$folder" "-DCOMPONENTS=core;core_dev;license" -DLIBDIR=lib
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
    "${as_root[@]}" mkdir -p "$root/build/package/packages" &&
    "${as_root[@]}" cp "$packages"/*.deb "$root/build/package/packages" &&
    "${as_root[@]}" rm "$root"/build/package/packages/libpcl*-dev_* &&
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 chroot "$root" sh -euc "
      apt-get update
      $(doc_block doc/guide.md 2)"'
      pcl_spherical_param_scan hand scan.ply
      pcl_spherical_param_reconstruction scan.ply mesh.ply -json report.json -report report.html
      grep -q "\"closed\": true" report.json && grep -q "\"vertices\": 5000" report.json
      python3 -c "import spherical_param"
      apt-get -y purge "*spherical-param*"
      ! ls /usr/bin /usr/lib/*/ | grep spherical'
}

check "static core: used by foreign projects" static_core || true
if check "package: made" made && check "package: unpacked" unpacked; then
  check "package: lintian finds no error" lintian_finds_no_error || true
  check "package: no path of the build" no_path_of_the_build || true
  check "package: foreign projects" foreign_projects || true
  if run "package: bare root" bare_root; then
    check "package: installed and used in the bare root" installed_and_used || true
  else
    skip "package: bare root" "mmdebstrap cannot make one here, see above"
  fi
fi
finish
