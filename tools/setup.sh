#!/usr/bin/env bash
# Installs those packages of tools/packages.txt that are missing. Does nothing, and needs neither
# network nor root, if there are none.
#
#   tools/setup.sh [NAME...]     those of tools/packages-NAME.txt, too
#   tools/setup.sh --demo        those of tools/packages.txt that the demo needs
set -euo pipefail

fail() {
  printf 'setup.sh: %s\n' "$1" >&2
  exit 1
}

if [ "$*" = -h ] || [ "$*" = --help ]; then
  sed -n -e '2,6s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
  exit 0
fi
folder="$(dirname "${BASH_SOURCE[0]}")"
lists=("$folder/packages.txt")
last='$'
if [ "$*" = --demo ]; then
  grep -q '^# The demo needs no more' "${lists[0]}" || fail "${lists[0]} does not say what the demo needs"
  last='/^# The demo needs no more/'
  shift
fi
for name in "$@"; do
  [ -f "$folder/packages-$name.txt" ] || fail "there is no list $folder/packages-$name.txt; -h says what to give"
  lists+=("$folder/packages-$name.txt")
done
command -v dpkg-query >/dev/null ||
  fail "this is not Debian: install what ${lists[*]} name by other means"

mapfile -t wanted < <(sed "${last}q" "${lists[@]}" | sed -e 's/#.*//' -e 's/[[:space:]]//g' -e '/^$/d' | sort -u)

# dpkg-query fails for names that it never heard of; those are missing as well.
installed="$(dpkg-query -W -f='${db:Status-Status} ${Package}\n' "${wanted[@]}" 2>/dev/null |
  sed -n 's/^installed //p' || true)"
missing=()
for name in "${wanted[@]}"; do
  grep -qxF "$name" <<<"$installed" || missing+=("$name")
done
if [ "${#missing[@]}" -eq 0 ]; then
  echo "setup.sh: all ${#wanted[@]} packages are installed"
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null ||
    fail "run as root, or install sudo; missing: ${missing[*]}"
  as_root=(sudo)
fi
echo "setup.sh: installing ${missing[*]}"
apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0)
"${apt[@]}" update ||
  fail "apt-get update failed: check the network and /etc/apt/sources.list"
"${apt[@]}" install -y --no-install-recommends "${missing[@]}" >/dev/null ||
  fail "apt-get could not install ${missing[*]}: see its message above"
echo "setup.sh: installed ${#missing[@]} of ${#wanted[@]} packages"
