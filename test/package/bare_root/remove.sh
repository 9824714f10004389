#!/bin/sh
# Run in the bare root: removes the packages, and looks for what they leave.
set -eu
apt-get -y purge '*spherical-param*'
find / -xdev \( -path /packages -o -path /var/cache -o -path /var/lib/apt -o -path /proc \) -prune \
  -o -name '*spherical[-_]param*' -print >/tmp/left
ldconfig -p | grep spherical_param >>/tmp/left || true
dpkg-query -W '*spherical-param*' >>/tmp/left 2>/dev/null || true
cat /tmp/left
[ ! -s /tmp/left ]
