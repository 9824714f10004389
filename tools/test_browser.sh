#!/usr/bin/env bash
# Tests reports of the tool in Debian's Chromium, without a window. Pictures of the page are in build/test-logs/browser.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=tools/common/test_steps.sh
. tools/common/test_steps.sh

# A sound mesh of a file whose name tries to be HTML, a cloud with an opening and outliers, what a
# depth camera at the origin sees of a ball, a mesh with handles, and two surfaces.
make_reports() {
  local tool="$PWD/build/release/bin/pcl_spherical_param" evil='a<img src=x onerror=document.title=1>.ply'
  (
    cd "$work" &&
      "${tool}_scan" hand "$evil" -points 3000 &&
      "${tool}_reconstruction" "$evil" mesh.ply -report sound.html &&
      "${tool}_scan" bowl bowl.xyz -points 3000 &&
      printf '%s\n' '3 0 1' '-2 1 0' >>bowl.xyz &&
      "${tool}_reconstruction" bowl.xyz mesh.ply -topology sphere -outliers 4 -smoothing 3 -report open.html &&
      "${tool}_scan" sphere ball.xyz -points 3000 &&
      awk '{ z = $3 + 3; if ($1 * $1 + $2 * $2 + $3 * z < 0) print $1, $2, z }' ball.xyz >seen.xyz &&
      "${tool}_reconstruction" seen.xyz mesh.ply -report camera.html &&
      "${tool}_scan" torus torus.xyz -points 3000 &&
      "${tool}_reconstruction" torus.xyz mesh.ply -report handles.html &&
      "${tool}_scan" pair pair.xyz -points 3000 &&
      "${tool}_reconstruction" pair.xyz mesh.ply -report pair.html
  )
}

need_packages browser
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

if check "tools: build" build_release pcl_spherical_param_scan \
  pcl_spherical_param_reconstruction && check "reports" make_reports; then
  check "reports in Chromium" timeout 900 /usr/bin/python3 test/browser/test_report_page.py \
    "$work/sound.html" "$work/open.html" "$work/camera.html" "$work/handles.html" \
    "$work/pair.html" "$logs/browser" || true
fi

finish
