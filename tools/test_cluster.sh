#!/usr/bin/env bash
# Tests of many scans under GNU parallel, and as an array job of a Slurm that runs on this machine
# for the test only, in a directory of its own.
#
# shellcheck disable=SC2317  # the steps are called by their names
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=tools/common/test_steps.sh
. tools/common/test_steps.sh

need_packages cluster

check "build" build_release pcl_spherical_param_reconstruction pcl_spherical_param_scan || finish

tool="$PWD/build/release/bin/pcl_spherical_param_reconstruction"
scan="$PWD/build/release/bin/pcl_spherical_param_scan"
array="$PWD/tools/slurm_array.sh"
work="$(mktemp -d "${TMPDIR:-/tmp}/spherical_param_cluster.XXXXXX")"
chmod 755 "$work"
daemons=()

clean_up() {
  local daemon
  if [ -n "${SLURM_CONF:-}" ] && [ "${#daemons[@]}" -eq 3 ]; then
    timeout 10 scancel --full -u "$(id -un)" >/dev/null 2>&1 || true
  fi
  # In the reverse order: slurmd tells slurmctld, both ask munged.
  for ((i = ${#daemons[@]} - 1; i >= 0; --i)); do
    daemon="${daemons[$i]}"
    kill "$daemon" 2>/dev/null || continue
    for _ in $(seq 50); do
      kill -0 "$daemon" 2>/dev/null || break
      sleep 0.1
    done
    kill -9 "$daemon" 2>/dev/null || true
    wait "$daemon" 2>/dev/null || true
  done
  rm -rf "$work"
}
trap clean_up EXIT

# Eleven scans, one with blanks in its name, and two that are none.
scans() {
  local number=0 shape
  mkdir -p "$work/scans" "$work/expected"
  for shape in sphere ellipsoid head bird hand animal dumbbell star snake plate; do
    number=$((number + 1))
    "$scan" "$shape" "$work/scans/$shape.ply" -points 1500 -seed "$number" || return 1
  done
  cp "$work/scans/hand.ply" "$work/scans/a hand's scan.ply"
  echo "no scan" >"$work/scans/bad.pcd"
  head -c 3000 "$work/scans/star.ply" >"$work/scans/cut.ply"
  find "$work/scans" -type f | LC_ALL=C sort >"$work/list"
  local input name
  while read -r input; do
    name="$(basename "$input")"
    case "$name" in
    bad.pcd | cut.ply) ;;
    *) "$tool" "$input" "$work/expected/${name%.*}.ply" -quiet || return 1 ;;
    esac
  done <"$work/list"
}

# records <file>: input and status of each, and that every line is an object.
records() {
  /usr/bin/python3 -c '
import json, os, sys
for line in open(sys.argv[1]):
    record = json.loads(line)
    print(record["status"], os.path.basename(record["input"]))' "$1"
}

# expect <what> <wanted>
expect() {
  [ "$1" = "$2" ] || {
    printf 'there is:\n%s\nwanted:\n%s\n' "$1" "$2"
    return 1
  }
}

# Every scan is meshed as alone, in a folder of meshes without anything else.
same_meshes() { diff -r "$work/expected" "$1"; }

all_records() {
  (
    printf 'failed bad.pcd\nfailed cut.ply\n'
    for mesh in "$work"/expected/*; do
      echo "done $(basename "$mesh")"
    done
  ) | sort
}

with_gnu_parallel() {
  (cd "$work" && PARALLEL_HOME="$work/parallel-home" parallel --will-cite -j 2 "$@" \
    "$tool" {} -output 'parallel/{name}.ply' -jsonl parallel.jsonl -resume -threads 1 :::: list)
}

gnu_parallel() {
  local status=0
  mkdir -p "$work/parallel-home"
  with_gnu_parallel --joblog "$work/jobs.log" || status=$?
  # Its exit code is the number of jobs that failed.
  expect "$status" 2 && same_meshes "$work/parallel" &&
    expect "$(records "$work/parallel.jsonl" | sort)" "$(all_records)" &&
    expect "$(awk 'NR > 1 && $7 != 0' "$work/jobs.log" | wc -l)" 2
}

gnu_parallel_resumes() {
  local status=0 before
  before="$(wc -l <"$work/parallel.jsonl")"
  rm "$work/parallel/hand.ply"
  # By its own log: those that failed; by our records: what is missing, too.
  with_gnu_parallel --joblog "$work/jobs.log" --resume-failed || status=$?
  expect "$status" 2 || return 1
  expect "$(tail -n +$((before + 1)) "$work/parallel.jsonl" | wc -l)" 2 || return 1
  status=0
  with_gnu_parallel || status=$?
  expect "$status" 2 && same_meshes "$work/parallel" &&
    expect "$(tail -n +$((before + 3)) "$work/parallel.jsonl" >"$work/new.jsonl" &&
      records "$work/new.jsonl" | sort)" \
      "$(printf 'done hand.ply\nfailed bad.pcd\nfailed cut.ply')"
}

free_ports() { # <count>
  /usr/bin/python3 -c '
import socket, sys
sockets = [socket.socket() for _ in range(int(sys.argv[1]))]
for s in sockets:
    s.bind(("127.0.0.1", 0))
print(*(s.getsockname()[1] for s in sockets))' "$1"
}

# wait_for <seconds> <command>...
wait_for() {
  local end=$((SECONDS + $1))
  shift
  until "$@" >/dev/null 2>&1; do
    [ "$SECONDS" -lt "$end" ] || return 1
    sleep 0.2
  done
}

# Starts munged, slurmctld and slurmd: with keys, sockets, ports, states and logs of their own.
start_slurm() {
  local node ports memory
  node="$(hostname -s)"
  read -r -a ports < <(free_ports 2)
  memory="$(awk '/^MemTotal:/ { print int($2 / 1024) }' /proc/meminfo)"
  mkdir -p "$work"/slurm/{state,spool}
  (umask 077 && head -c 1024 /dev/urandom >"$work/slurm/munge.key")
  cat >"$work/slurm/slurm.conf" <<CONF
ClusterName=test
SlurmctldHost=$node(127.0.0.1)
SlurmUser=root
SlurmctldPort=${ports[0]}
SlurmdPort=${ports[1]}
AuthType=auth/munge
AuthInfo=socket=$work/slurm/munge.socket
CredType=cred/munge
StateSaveLocation=$work/slurm/state
SlurmdSpoolDir=$work/slurm/spool
SlurmctldPidFile=$work/slurm/slurmctld.pid
SlurmdPidFile=$work/slurm/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
SwitchType=switch/none
MpiDefault=none
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
JobCompType=jobcomp/none
ReturnToService=2
MinJobAge=3600
SchedulerParameters=batch_sched_delay=0
KillWait=5
NodeName=$node NodeAddr=127.0.0.1 CPUs=$jobs RealMemory=$memory
PartitionName=test Nodes=$node Default=YES MaxTime=INFINITE State=UP
CONF
  export SLURM_CONF="$work/slurm/slurm.conf"
  PATH="$PATH:/usr/sbin:/sbin"
  # In this shell, not in a step's log: what stops them has to know them.
  munged --foreground --force --key-file="$work/slurm/munge.key" \
    --socket="$work/slurm/munge.socket" --pid-file="$work/slurm/munged.pid" \
    --log-file="$work/slurm/munged.log" --seed-file="$work/slurm/munge.seed" \
    >"$work/slurm/munged.out" 2>&1 &
  daemons+=("$!")
  wait_for 20 munge -n -S "$work/slurm/munge.socket" || return 1
  slurmctld -D -i -f "$SLURM_CONF" >"$work/slurm/slurmctld.log" 2>&1 &
  daemons+=("$!")
  slurmd -D -f "$SLURM_CONF" -N "$node" >"$work/slurm/slurmd.log" 2>&1 &
  daemons+=("$!")
  wait_for 40 sh -c 'sinfo -h -o %T | grep -qx idle'
}

# A queue that does not answer is not empty.
no_jobs() {
  local queued
  queued="$(squeue -h)" && [ -z "$queued" ]
}

submit() { # <array> <option...>: prints the job's number
  local array_of="$1"
  shift
  (cd "$work" && SPHERICAL_PARAM_TOOL="$tool" sbatch --parsable --array="$array_of" \
    --cpus-per-task=1 --mem=500M "$array" list 'slurm/meshes/{name}.ply' slurm/records "$@")
}

state_of() { # <job>: states of its tasks
  scontrol show job "$1" | sed -n 's/^ *JobState=\([A-Z]*\).*/\1/p' | sort | uniq -c |
    sed 's/^ *//'
}

records_of_tasks() {
  cat "$work"/slurm/records/*.jsonl >"$work/slurm.jsonl"
  records "$work/slurm.jsonl" | sort
}

slurm_array() {
  job="$(submit 0-3)" || return 1
  wait_for 90 no_jobs || {
    squeue
    scontrol show job "$job"
    return 1
  }
  tail -n 30 "$work"/slurm-*.log
  # bad.pcd and cut.ply are the third and the fifth of the list: of the third and the first task.
  expect "$(state_of "$job")" "$(printf '2 COMPLETED\n2 FAILED')" &&
    same_meshes "$work/slurm/meshes" && expect "$(records_of_tasks)" "$(all_records)"
}

slurm_requeue() {
  local count
  count="$(wc -l <"$work/slurm.jsonl")"
  # A task of scans that are all there, and one with a scan that fails and one that is missing.
  rm "$work/slurm/meshes/snake.ply"
  job="$(submit 0-3)" || return 1
  wait_for 90 no_jobs || return 1
  same_meshes "$work/slurm/meshes" || return 1
  records_of_tasks >/dev/null
  expect "$(wc -l <"$work/slurm.jsonl")" "$((count + 3))" || return 1
  scontrol requeue "${job}_1" || return 1
  # Slurm lets a task wait for two minutes before it runs again.
  scontrol update "JobId=${job}_1" StartTime=now || return 1
  wait_for 90 no_jobs || return 1
  expect "$(scontrol show job "${job}_1" | grep -o 'Restarts=[0-9]*')" "Restarts=1" || return 1
  records_of_tasks >/dev/null
  expect "$(wc -l <"$work/slurm.jsonl")" "$((count + 3))"
}

slurm_cancel() {
  local many="$work/many" number
  mkdir -p "$many"
  for number in $(seq 16); do
    "$scan" hand "$many/$number.ply" -points 4000 -seed "$number" || return 1
  done
  find "$many" -type f | LC_ALL=C sort >"$work/list"
  job="$(submit 0 -tolerance 1e-8)" || return 1
  wait_for 60 test -s "$work/slurm/records/0-of-1.jsonl" || return 1
  scancel "$job"
  wait_for 60 no_jobs || return 1
  tail -n 60 "$work/slurm-${job}_0.log"
  # No file is half there, and the same task goes on.
  expect "$(find "$work/slurm/meshes" -name '.spherical_param.*')" "" || return 1
  local made
  made="$(grep -c '"status":"done"' "$work/slurm/records/0-of-1.jsonl")"
  [ "$made" -lt 16 ] || return 1
  job="$(submit 0 -tolerance 1e-8)" || return 1
  wait_for 120 no_jobs || return 1
  expect "$(state_of "$job")" "1 COMPLETED" &&
    expect "$(grep -c '"status":"done"' "$work/slurm/records/0-of-1.jsonl")" 16 &&
    grep -q "$made up to date" "$work/slurm-${job}_0.log"
}

if check "scans, each meshed alone" scans; then
  check "GNU parallel" gnu_parallel || true
  check "GNU parallel: resumes" gnu_parallel_resumes || true
  if [ "$(id -u)" -ne 0 ]; then
    skip "Slurm" "its daemons need root"
  elif ! start_slurm; then
    tail -n 15 "$work"/slurm/*.log "$work"/slurm/*.out | sed 's/^/    /'
    skip "Slurm" "its daemons do not run here, see above"
  else
    check "Slurm: array job" slurm_array || true
    check "Slurm: submitted again, requeued" slurm_requeue || true
    check "Slurm: cancelled, submitted again" slurm_cancel || true
  fi
fi

finish
