#!/usr/bin/env bash
#SBATCH --job-name=spherical_param
#SBATCH --output=slurm-%A_%a.log
#
# Meshes the scans of a list as an array job of Slurm. Each task takes its part of the list.
#
#   sbatch --array=0-7 --cpus-per-task=2 slurm_array.sh LIST MESHES [option...]
#
#   LIST    a file with the path of a scan on each line
#   MESHES  the folder of the meshes: scans/hand.pcd becomes MESHES/hand.ply
#
# Further options are those of pcl_spherical_param_reconstruction. A mesh that exists is not made
# again, so that the same command resumes a job. A task fails if one of its scans fails, but meshes
# the others.
set -euo pipefail

if [ "$#" -lt 2 ] || [ -z "${SLURM_ARRAY_TASK_COUNT:-}" ]; then
  echo "usage: sbatch --array=0-N slurm_array.sh LIST MESHES [option...]" >&2
  exit 2
fi
list="$1" meshes="$2"
shift 2
tasks="$SLURM_ARRAY_TASK_COUNT"
task="$((SLURM_ARRAY_TASK_ID - SLURM_ARRAY_TASK_MIN))"
if [ "$((SLURM_ARRAY_TASK_MAX - SLURM_ARRAY_TASK_MIN + 1))" -ne "$tasks" ]; then
  echo "slurm_array.sh: the array has gaps; give --array=0-N" >&2
  exit 2
fi
mapfile -t scans < <(grep . "$list")
mkdir -p "$meshes"
failed=0
for ((i = task; i < ${#scans[@]}; i += tasks)); do
  name="$(basename "${scans[i]}")"
  mesh="$meshes/${name%.*}.ply"
  [ -e "$mesh" ] || pcl_spherical_param_reconstruction "${scans[i]}" "$mesh" -quiet \
    -threads "${SLURM_CPUS_PER_TASK:-1}" "$@" || failed=1
done
exit "$failed"
