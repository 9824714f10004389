#!/usr/bin/env bash
# Tests of the Python package that need more packages: its wheel in an environment of its own, and
# its types. What the module does is tested by tools/test.sh.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=tools/common/test_steps.sh
. tools/common/test_steps.sh

python=/usr/bin/python3
cmake_args="-DSPHERICAL_PARAM_WERROR=ON -DSPHERICAL_PARAM_HARDENING=ON"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

typed() {
  MYPYPATH=build/release/python mypy --config-file pyproject.toml --strict --cache-dir "$work/mypy" "$@"
}

strictly_typed() {
  typed -p spherical_param && typed src/python/examples/*.py
}

# mypy must find wrong use.
wrong_use_is_found() {
  cat >"$work/wrong.py" <<'END'
import spherical_param

spherical_param.reconstruct([[0.0, 0.0, 0.0]], graph="voronoi")
mesh = spherical_param.reconstruct([[0.0, 0.0, 0.0]], topology="sphere")
mesh.polygons
text: str = mesh.measures.volume
both = spherical_param.reconstruct("scan.ply", parts="each")
both.vertices
good: spherical_param.Result = spherical_param.reconstruct("scan.ply", parts="largest")
END
  typed "$work/wrong.py" >"$work/wrong.log" && return 1
  cat "$work/wrong.log"
  [ "$(grep -c '^[^ ]*wrong.py:[356]: error' "$work/wrong.log")" -eq 3 ] &&
    ! grep -q 'wrong.py:[89]:' "$work/wrong.log"
}

# As printed, in a clone and an environment of its own.
wheel_builds_and_installs() {
  git clone -q . "$work/clone" && "$python" -m venv --system-site-packages "$work/venv" &&
    (cd "$work/clone" && CCACHE_BASEDIR="$PWD" CMAKE_BUILD_PARALLEL_LEVEL="$jobs" \
      CMAKE_ARGS="$cmake_args" \
      PATH="$work/venv/bin:$PATH" bash -euc "$(doc_block doc/guide.md 1)") &&
    mkdir "$work/wheels" && mv "$work"/clone/*.whl "$work/wheels" && rm -rf "$work/clone"
}

wheel_holds_what_it_must() {
  local list name
  list="$("$python" -m zipfile -l "$(echo "$work"/wheels/spherical_param-*-linux_*.whl)")"
  echo "$list"
  for name in __init__.py py.typed _core.pyi '_core\..*\.so'; do
    grep -q "^spherical_param/$name " <<<"$list" || return 1
  done
  grep -q '^spherical_param-.*\.dist-info/LICENSE ' <<<"$list" &&
    ! grep -q -E 'CMake|\.cpp|\.a ' <<<"$list"
}

wheel_says_what_it_is() {
  "$work/venv/bin/python" -c '
from importlib.metadata import metadata
import spherical_param
found = metadata("spherical-param")
assert found["Version"] == spherical_param.__version__, found["Version"]
assert found["License"] == "BSD-3-Clause" and found["Requires-Python"] == ">=3.9"
assert "Pcl" not in found["Requires-Dist"] and "numpy" in found["Requires-Dist"]
'
}

wheel_needs_no_folder_of_the_build() {
  local module
  module="$(echo "$work"/venv/lib/python3*/site-packages/spherical_param/_core*.so)"
  readelf -d "$module"
  ! readelf -d "$module" | grep -q -E 'RPATH|RUNPATH|libspherical_param|libpcl|libboost|libpng' &&
    ! ldd "$module" | grep "not found" && ! grep -q "$PWD" "$module"
}

open3d_has_the_same_mesh() {
  PYTHONPATH="$PWD/build/release/python:test/python" "$python" -m unittest -v \
    test_package.Conversions.test_other_libraries_have_the_same_mesh \
    test_clouds.Clouds.test_clouds_and_meshes_of_open3d_are_taken
}

source_distribution_is_made() {
  "$python" -c '
import sys
from setuptools import build_meta
print(build_meta.build_sdist(sys.argv[1]))' "$work/sdist"
}

# installs <wheel or source distribution>: in an environment of Python, NumPy and, to build, wheel alone; and
# works there.
installs() {
  rm -rf "$work/empty" && "$python" -m venv "$work/empty" &&
    ln -s /usr/lib/python3/dist-packages/{numpy,wheel}* "$(echo "$work"/empty/lib/python3*/site-packages)" &&
    TMPDIR="$work" CCACHE_BASEDIR="$work" CMAKE_BUILD_PARALLEL_LEVEL="$jobs" CMAKE_ARGS="$cmake_args" \
      "$work/empty/bin/python" -m pip install --no-index --no-build-isolation "$1" &&
    "$work/empty/bin/python" -m pip check && (cd "$work" && "$work/empty/bin/python" -I -c '
import sys
import numpy as np
import spherical_param
points = np.random.default_rng(1).normal(size=(500, 3))
np.savetxt("scan.xyz", points / np.linalg.norm(points, axis=1, keepdims=True))
mesh = spherical_param.reconstruct("scan.xyz", progress=True)
assert len(mesh.triangles) == 996 and mesh.verdict == "A sound mesh.", mesh.verdict
mesh.write("mesh.obj")
mesh.report("page.html")
half = spherical_param.morph(mesh, spherical_param.reconstruct("mesh.obj")).at(0.5)
assert len(half.triangles) >= 996
others = {"matplotlib", "open3d", "meshio", "trimesh"} & set(sys.modules)
assert not others, others
')
}

need_packages python
if check "python: module" build_release spherical_param_python; then
  check "python: strictly typed" strictly_typed || true
  check "python: wrong use is found by its types" wrong_use_is_found || true
fi
if run "python: Open3D" tools/setup.sh open3d; then
  check "python: Open3D has the same mesh, and its clouds are taken" open3d_has_the_same_mesh || true
else
  skip "python: Open3D has the same mesh" "python3-open3d cannot be had"
fi
if ! "$python" -c 'import trimesh' 2>/dev/null; then
  skip "python: trimesh has the same mesh" "Debian 12 has no trimesh, and it is not installed"
fi
if check "wheel: builds and installs" wheel_builds_and_installs; then
  check "wheel: holds what it must" wheel_holds_what_it_must || true
  check "wheel: says what it is" wheel_says_what_it_is || true
  check "wheel: needs no folder of the build" wheel_needs_no_folder_of_the_build || true
  check "wheel: installs and works with NumPy alone" installs "$(echo "$work"/wheels/*.whl)" || true
fi
if check "source distribution: made" source_distribution_is_made; then
  check "source distribution: installs and works with NumPy alone" \
    installs "$(echo "$work"/sdist/*.tar.gz)" || true
fi
finish
