#!/usr/bin/env bash
#SBATCH --job-name=spherical_param
#SBATCH --output=slurm-%A_%a.log
#SBATCH --requeue
#
# Meshes many scans as an array job of Slurm: each task takes its share of a list.
#
#   sbatch --array=0-7 --cpus-per-task=4 --mem=8G slurm_array.sh LIST PATTERN RECORDS [option...]
#
#   LIST     a file with the path of a scan on each line, the same while the job runs
#   PATTERN  where meshes go, as in 'meshes/{name}.ply'
#   RECORDS  a directory for lines of JSON, in a file for each task; cat joins them
#
# Further options are those of pcl_spherical_param_reconstruction; SPHERICAL_PARAM_TOOL names
# another place of it. A task that is requeued, or submitted again with the same number of tasks,
# goes on where it was; single ones of N tasks that began at 0 are submitted again with
# SPHERICAL_PARAM_SHARES=N sbatch --array=3,5 ... It fails if one of its scans does; the others are
# meshed all the same.
set -euo pipefail

if [ "$#" -lt 3 ]; then
  echo "usage: sbatch --array=0-N slurm_array.sh LIST PATTERN RECORDS [option...]" >&2
  exit 2
fi
list="$1" pattern="$2" records="$3"
shift 3

refuse() { # <cause> <remedy>
  printf '%s: %s\n  remedy: %s\n' "slurm_array.sh" "$1" "$2" >&2
  exit 2
}

task="${SLURM_ARRAY_TASK_ID:-0}"
if [ -n "${SPHERICAL_PARAM_SHARES:-}" ]; then
  share="$task" shares="$SPHERICAL_PARAM_SHARES"
  [ "$share" -lt "$shares" ] ||
    refuse "task $share of SPHERICAL_PARAM_SHARES=$shares" "give --array numbers from 0 to N - 1"
else
  step="${SLURM_ARRAY_TASK_STEP:-1}"
  least="${SLURM_ARRAY_TASK_MIN:-0}"
  shares="${SLURM_ARRAY_TASK_COUNT:-1}"
  share="$(((task - least) / step))"
  # A list of numbers has gaps, so that a task does not know its place in it.
  [ "$(((${SLURM_ARRAY_TASK_MAX:-$least} - least) / step + 1))" -eq "$shares" ] ||
    refuse "the tasks of the array are a list with gaps" \
      "give --array=0-N, or SPHERICAL_PARAM_SHARES=N for some tasks of N"
fi
cpus="${SLURM_CPUS_PER_TASK:-1}"
limits=(-jobs "$cpus" -threads 1)
if [ -n "${SLURM_MEM_PER_NODE:-}" ]; then
  limits+=(-memory "${SLURM_MEM_PER_NODE}M")
elif [ -n "${SLURM_MEM_PER_CPU:-}" ]; then
  limits+=(-memory "$((SLURM_MEM_PER_CPU * cpus))M")
fi

mkdir -p "$records"
# In the place of the shell, so that a cancelled task is told, and ends in good order.
exec "${SPHERICAL_PARAM_TOOL:-pcl_spherical_param_reconstruction}" -inputs "$list" \
  -output "$pattern" -shard "$share/$shares" -jsonl "$records/$share-of-$shares.jsonl" -resume \
  "${limits[@]}" "$@"
