#!/bin/sh
# Run in the bare root: installs the packages beside this script with what they depend on.
set -eu
cd "$(dirname "$0")"
export DEBIAN_FRONTEND=noninteractive

# PCL's own development files would take minutes: of the package that needs them is only asked
# whether it could be installed.
packages=""
for package in ./*.deb; do
  case "$package" in
  ./libpcl-spherical-param-dev_*) pcl_dev="$package" ;;
  *) packages="$packages $package" ;;
  esac
done
# shellcheck disable=SC2086  # a list
apt-get -y --no-install-recommends -o Dpkg::Options::=--force-unsafe-io install $packages
apt-get -s --no-install-recommends install "$pcl_dev"
