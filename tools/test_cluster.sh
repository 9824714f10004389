#!/usr/bin/env bash
# Runs the commands of doc/guide.md as they are printed there: under GNU parallel, and in a Slurm
# that is started on this machine for the test only.
#
# shellcheck disable=SC2317  # the steps are called by their names
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=tools/common/test_steps.sh
. tools/common/test_steps.sh

need_packages cluster
check "build" build_release pcl_spherical_param_reconstruction pcl_spherical_param_scan || finish

PATH="$PWD/build/release/bin:$PATH:/usr/sbin"
root="$PWD"
work="$(mktemp -d "${TMPDIR:-/tmp}/spherical_param_cluster.XXXXXX")"
export PARALLEL_HOME="$work/parallel"
daemons=()

clean_up() {
  # In reverse order: slurmd needs slurmctld, and both need munged.
  local i
  for ((i = ${#daemons[@]} - 1; i >= 0; --i)); do
    kill "${daemons[i]}" 2>/dev/null && timeout 10 tail --pid="${daemons[i]}" -f /dev/null
    kill -9 "${daemons[i]}" 2>/dev/null || true
  done
  rm -rf "$work"
}
trap clean_up EXIT

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

# wait_for <seconds> <command>...
wait_for() {
  local end=$((SECONDS + $1))
  shift
  until "$@" >/dev/null 2>&1; do
    [ "$SECONDS" -lt "$end" ] || return 1
    sleep 0.2
  done
}

# Starts munged, slurmctld and slurmd, with all their files in a folder of the test.
start_slurm() {
  local node s="$work/slurm" ports
  node="$(hostname -s)"
  ports="$(/usr/bin/python3 -c '
import socket
sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(2)]
print(*(s.getsockname()[1] for s in sockets))')"
  mkdir -p "$s/state" "$s/spool"
  chmod 755 "$work"
  (umask 077 && head -c 1024 /dev/urandom >"$s/key")
  export SLURM_CONF="$s/slurm.conf"
  printf '%s\n' ClusterName=test "SlurmctldHost=$node(127.0.0.1)" SlurmUser=root \
    "SlurmctldPort=${ports% *}" "SlurmdPort=${ports#* }" AuthType=auth/munge \
    "AuthInfo=socket=$s/socket" CredType=cred/munge "StateSaveLocation=$s/state" \
    "SlurmdSpoolDir=$s/spool" "SlurmctldPidFile=$s/slurmctld.pid" "SlurmdPidFile=$s/slurmd.pid" \
    ProctrackType=proctrack/linuxproc TaskPlugin=task/none SelectType=select/cons_tres \
    SelectTypeParameters=CR_CPU SwitchType=switch/none MpiDefault=none \
    AccountingStorageType=accounting_storage/none JobAcctGatherType=jobacct_gather/none \
    JobCompType=jobcomp/none SlurmdParameters=config_overrides \
    SchedulerParameters=batch_sched_delay=0 \
    "NodeName=$node NodeAddr=127.0.0.1 CPUs=2" \
    "PartitionName=test Nodes=$node Default=YES State=UP" >"$SLURM_CONF"
  munged --foreground --force --key-file="$s/key" --socket="$s/socket" --pid-file="$s/munged.pid" \
    --log-file="$s/munged.log" --seed-file="$s/seed" >"$s/munged.out" 2>&1 &
  daemons+=("$!")
  wait_for 20 munge -n -S "$s/socket" || return 1
  slurmctld -D -i >"$s/slurmctld.log" 2>&1 &
  daemons+=("$!")
  slurmd -D -N "$node" >"$s/slurmd.log" 2>&1 &
  daemons+=("$!")
  wait_for 40 sh -c 'sinfo -h -o %T | grep -qx idle'
}

# The array job of the page; fails if one of its tasks does.
array_job() {
  local job
  job="$(here "$(doc_block "$root/doc/guide.md" 3)")" || return 2
  wait_for 90 sh -c 'queue="$(squeue -h)" && [ -z "$queue" ]' || return 2
  tail -n 5 "$work"/here/slurm-*.log
  [[ "$(scontrol show job "${job##* }")" != *JobState=FAILED* ]]
}

if check "scans, each meshed alone" scans; then
  check "GNU parallel: one scan fails, resumes" resumes one_machine || true
  check "GNU parallel with machines: one scan fails, resumes" resumes several_machines || true
  if [ "$(id -u)" -ne 0 ] || ! start_slurm; then
    skip "Slurm" "its daemons do not run here"
  else
    check "Slurm: one scan fails, resumes" resumes array_job || true
  fi
fi

finish
