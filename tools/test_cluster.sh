#!/usr/bin/env bash
# Runs the commands of doc/guide.md as they are printed there: under GNU parallel, and with a stand-in
# for Slurm.
#
# shellcheck disable=SC2317  # the steps are called by their names
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=tools/common/test_steps.sh
. tools/common/test_steps.sh

need_packages cluster
check "build" build_release pcl_spherical_param_reconstruction pcl_spherical_param_scan || finish

PATH="$PWD/build/release/bin:$PATH"
root="$PWD"
work="$(mktemp -d "${TMPDIR:-/tmp}/spherical_param_cluster.XXXXXX")"
export PARALLEL_HOME="$work/parallel"
trap 'rm -rf "$work"' EXIT

# here <commands>: runs commands of the page, in the folder of the scans.
here() { (cd "$work/here" && bash -euc "$1"); }

# Five scans with their meshes; one of the scans is broken, its name has blanks.
scans() (
  mkdir -p "$work/here/scans" "$work/expected" "$PARALLEL_HOME"
  touch "$PARALLEL_HOME/will-cite"
  cd "$work/here"
  cp "$root/tools/slurm_array.sh" .
  echo "1/:" >machines.txt
  local shape
  for shape in hand head bird star "a b"; do
    pcl_spherical_param_scan "${shape/a b/animal}" "scans/$shape.ply" -points 800 &&
      pcl_spherical_param_reconstruction "scans/$shape.ply" "$work/expected/$shape.ply" -quiet ||
      return 1
  done
)

break_scan() {
  mv "$work/here/scans/a b.ply" "$work/whole" && echo "no scan" >"$work/here/scans/a b.ply"
  rm -rf "$work/here/meshes" "$work/here/jobs.log"
}
mend_scan() { mv "$work/whole" "$work/here/scans/a b.ply"; }

# The four meshes of the good scans and nothing else, the same bytes as of a run for each alone.
four_meshes() {
  [ "$(diff -r "$work/expected" "$work/here/meshes")" = "Only in $work/expected: a b.ply" ]
}
five_meshes() { diff -r "$work/expected" "$work/here/meshes"; }
# Changes if a mesh is made again.
files_of_the_four() {
  (cd "$work/here/meshes" && stat -c '%n %i %z' bird.ply hand.ply head.ply star.ply)
}

# resumes <step>: the step fails for the broken scan alone; again with a good one, it makes that mesh
# and no other.
resumes() {
  local status=0 before
  break_scan
  "$1" || status=$?
  [ "$status" -eq 1 ] && four_meshes || return 1
  before="$(files_of_the_four)"
  mend_scan
  "$1" && five_meshes && [ "$before" = "$(files_of_the_four)" ]
}

one_machine() { here "$(doc_block "$root/doc/guide.md" 1)"; }
several_machines() { here "$(doc_block "$root/doc/guide.md" 2)"; }

# sbatch --array=0-N --cpus-per-task=C <script> [argument...]: the tasks one after the other, with the
# variables that Slurm gives them; fails if one of them does.
sbatch() {
  local last="${1#--array=0-}" cpus="${2#--cpus-per-task=}" failed=0 task
  shift 2
  for ((task = 0; task <= last; ++task)); do
    SLURM_ARRAY_TASK_ID="$task" SLURM_ARRAY_TASK_MIN=0 SLURM_ARRAY_TASK_MAX="$last" \
      SLURM_ARRAY_TASK_COUNT="$((last + 1))" SLURM_CPUS_PER_TASK="$cpus" bash "$@" || failed=1
  done
  return "$failed"
}
export -f sbatch

array_job() { here "$(doc_block "$root/doc/guide.md" 3)"; }

if check "scans, each meshed alone" scans; then
  check "GNU parallel: one scan fails, resumes" resumes one_machine || true
  check "GNU parallel with machines: one scan fails, resumes" resumes several_machines || true
  check "array job: one scan fails, resumes" resumes array_job || true
fi

finish
