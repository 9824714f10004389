#!/bin/sh
# Run where the packages are installed: use.sh <name of a tool>... Nothing of the build is there.
set -eu

folder="$(mktemp -d)"
cd "$folder"
for name in "$@"; do
  tool="pcl_spherical_param_$name"
  [ "$(command -v "$tool")" = "/usr/bin/$tool" ]
  "$tool" -version
  # All libraries are found, ours where the packages put them.
  ldd "/usr/bin/$tool" >libraries
  if grep 'not found' libraries || grep 'spherical_param' libraries | grep -v '=> /\(usr/\)\?lib/'; then
    exit 1
  fi
  # The tool for scans needs none of ours.
  [ "$name" = scan ] || [ "$(grep -c spherical_param libraries)" -eq 2 ]
  man -w "$tool"
  man "$tool" | grep EXAMPLES >/dev/null
  [ -s "/usr/share/doc/pcl-spherical-param-tools/copyright" ]
done
if ! ldconfig -p | grep -q libpcl_spherical_param.so.0; then
  echo "ldconfig was not run"
  exit 1
fi

pcl_spherical_param_scan hand scan.ply
pcl_spherical_param_reconstruction scan.ply mesh.ply -sphere sphere.ply -json report.json
grep -q '"closed": true' report.json
grep -q '"genus": 0' report.json
grep -q '"vertices": 5000' report.json
[ "$(head -c 3 mesh.ply)" = ply ]
pcl_spherical_param_reconstruction scan.ply mesh.ply -report page.html -quiet
[ -s page.html ]
pcl_spherical_param_remesh scan.ply even.ply -points 642 -quiet
pcl_spherical_param_texture scan.ply textured.glb -checker 8 -quiet
pcl_spherical_param_scan bird other.ply -points 2000
pcl_spherical_param_morph scan.ply other.ply morph.ply -frames 3 -quiet
[ -s even.ply ] && [ -s textured.glb ] && [ -s morph_002.ply ]
# From Python, too.
/usr/bin/python3 - <<'EOF'
import numpy
import spherical_param
points = numpy.random.default_rng(1).normal(size=(1000, 3))
mesh = spherical_param.reconstruct(points / numpy.linalg.norm(points, axis=1, keepdims=True))
assert mesh.triangles.shape == (1996, 3), mesh
assert spherical_param.__file__.startswith("/usr/lib/python3"), spherical_param.__file__
EOF
# Bad input: no file, and the exit code for it.
code=0
pcl_spherical_param_reconstruction absent.ply none.ply || code=$?
[ "$code" -eq 1 ] && [ ! -e none.ply ]
cd / && rm -rf "$folder"
