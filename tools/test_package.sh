#!/usr/bin/env bash
# The Debian packages: made, judged by lintian, used where they are unpacked, and installed into a
# bare root, used from there and removed again.
#
#   tools/test_package.sh
#
# The bare root and what apt downloads into it are kept in build/bare-root. Nothing is mounted.
#
# shellcheck disable=SC2317  # the functions are called by check() and run()
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=tools/common/test_steps.sh
. tools/common/test_steps.sh
need_packages package

packages="$PWD/build/package/packages"
work="$PWD/build/test-package"
cache="$PWD/build/bare-root"
tools=(morph reconstruction remesh scan texture)
as_root=()
[ "$(id -u)" -eq 0 ] || as_root=(sudo)
"${as_root[@]}" rm -rf "$work"
mkdir -p "$work" "$cache"
root="$work/root"
trap '"${as_root[@]}" rm -rf "$work"' EXIT

build() {
  # As tools/test.sh has it, so that a hardened release build gives the same objects.
  cmake --preset package -DSPHERICAL_PARAM_WERROR=ON &&
    cmake --build --preset package -j "$jobs"
}

make_packages() {
  rm -rf "$packages"
  cpack --config build/package/CPackConfig.cmake &&
    [ "$(find "$packages" -maxdepth 1 -name '*.deb' | wc -l)" -eq 6 ]
}

made_again() {
  cpack --config build/package/CPackConfig.cmake -B "$work/again" || return 1
  local package
  for package in "$packages"/*.deb; do
    cmp "$package" "$work/again/${package##*/}" || return 1
  done
}

lintian_is_content() {
  lintian --allow-root --pedantic --fail-on error,warning "$packages"/*.deb
}

unpack() {
  local package
  for package in "$packages"/*.deb; do
    dpkg-deb --extract "$package" "$work/unpacked" || return 1
  done
}

man_pages_are_good() {
  local tool page
  for tool in "${tools[@]}"; do
    page="$work/unpacked/usr/share/man/man1/pcl_spherical_param_$tool.1.gz"
    zcat "$page" >"$work/page.1" && mandoc -T lint -W warning "$work/page.1" &&
      LC_ALL=C MANROFFSEQ='' man --warnings -l "$page" 2>"$work/warnings" | grep EXAMPLES >/dev/null &&
      [ ! -s "$work/warnings" ] || return 1
  done
}

no_path_of_the_build() {
  if grep -r --text -l -F -e "$PWD" "$work/unpacked"; then
    return 1
  fi
}

foreign_projects() {
  local multiarch
  multiarch="$(dpkg-architecture -qDEB_HOST_MULTIARCH)"
  cmake -DSOURCE_DIR="$PWD" -DBUILD_DIR="$PWD/build/package" -DWORK_DIR="$work/consumers" \
    -DPREFIX="$work/unpacked/usr" "-DCOMPONENTS=core;pcl" -DGENERATOR=Ninja -DCXX=c++ \
    -DLIBDIR="lib/$multiarch" -DPKG_CONFIG=pkg-config \
    -DVERSION="$(sed -n 's/^project(.* VERSION \([0-9.]*\) .*/\1/p' CMakeLists.txt)" \
    -P test/package/run_package_test.cmake
}

# Files of a component that no package has must not be left out silently.
strays_are_refused() {
  echo "install(FILES \${PROJECT_SOURCE_DIR}/README.md DESTINATION share COMPONENT stray)" \
    >"$work/stray.cmake"
  cmake --preset package -B "$work/stray" \
    -DCMAKE_PROJECT_pcl_spherical_param_INCLUDE="$work/stray.cmake" || return 1
  if cpack --config "$work/stray/CPackConfig.cmake" 2>"$work/error"; then
    return 1
  fi
  cat "$work/error"
  grep -q "no package has the install component 'stray'" "$work/error" &&
    [ -z "$(find "$work/stray" -name '*.deb')" ]
}

in_root() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 \
    chroot "$root" "$@"
}

# The same release and mirror as this machine's.
make_bare_root() {
  local suite sources=() file
  suite="$(. /etc/os-release && echo "$VERSION_CODENAME")"
  for file in /etc/apt/sources.list /etc/apt/sources.list.d/debian.sources; do
    [ ! -s "$file" ] || sources+=("$file")
  done
  "${as_root[@]}" mmdebstrap --format=tar --variant=minbase --include=man-db \
    --aptopt='APT::Install-Recommends "false"' --dpkgopt=force-unsafe-io \
    --skip=cleanup/apt/lists "$suite" "$cache/bare.tar.part" "${sources[@]}" &&
    "${as_root[@]}" mv "$cache/bare.tar.part" "$cache/bare.tar"
}

have_bare_root() {
  # What the mirror has changes from time to time.
  find "$cache" -name bare.tar -mtime +5 -exec "${as_root[@]}" rm {} +
  [ -s "$cache/bare.tar" ] || make_bare_root
}

bare_root_unpacked() {
  mkdir -p "$root" && "${as_root[@]}" tar -xf "$cache/bare.tar" -C "$root" --exclude=./dev/* &&
    { "${as_root[@]}" mknod -m 666 "$root/dev/null" c 1 3 || true; } &&
    "${as_root[@]}" mkdir "$root/packages" &&
    "${as_root[@]}" cp "$packages"/*.deb test/package/bare_root/*.sh "$root/packages" &&
    in_root true
}

keep_downloads() {
  "${as_root[@]}" mkdir -p "$cache/archives"
  "${as_root[@]}" find "$root/var/cache/apt/archives" -maxdepth 1 -name '*.deb' \
    -exec cp -n -t "$cache/archives" {} +
}

installed_in_root() {
  local archives="$root/var/cache/apt/archives"
  if [ -d "$cache/archives" ]; then
    "${as_root[@]}" find "$cache/archives" -name '*.deb' -exec cp -t "$archives" {} +
  fi
  in_root sh /packages/install.sh || {
    # What the lists name may be gone.
    in_root apt-get update && in_root sh /packages/install.sh
  } || return 1
  keep_downloads
}

used_from_root() {
  in_root sh /packages/use.sh "${tools[@]}"
}

removed_from_root() {
  in_root sh /packages/remove.sh
}

if check "package: build" build && check "package: packages" make_packages; then
  check "package: the same bytes again" made_again || true
  check "package: lintian" lintian_is_content || true
  if check "package: unpacked" unpack; then
    check "package: manual pages" man_pages_are_good || true
    check "package: no path of the build" no_path_of_the_build || true
    check "package: foreign projects" foreign_projects || true
  fi
  check "package: strays are refused" strays_are_refused || true
  if ! run "package: bare root" have_bare_root; then
    skip "package: bare root" "mmdebstrap cannot make one here, see above"
  elif check "package: bare root unpacked" bare_root_unpacked &&
    check "package: installed in the bare root" installed_in_root; then
    check "package: used from the bare root" used_from_root || true
    check "package: removed without a trace" removed_from_root || true
  fi
fi
finish
