#!/usr/bin/env bash
# Runs map.sbatch on a Slurm of its own: munged, slurmctld and slurmd on this machine, in a
# temporary folder, on ports of their own, stopped at the end. Compares the joined table with that
# of one run. Needs root and Debian's packages slurmctld, slurmd, slurm-client and munge; an
# existing Slurm of this machine is left alone.
#
#     examples/slurm/single_node.sh [BRAKEWAVE [PROBLEM [SHARDS]]]
set -euo pipefail

here=$(cd "$(dirname "$0")" && pwd)
brakewave=$(realpath "${1:-$here/../../target/release/brakewave}")
problem=$(realpath "${2:-$here/../../problems/mode4_map.ron}")
shards=${3:-4}
[[ $(id -u) == 0 ]] || { echo "slurmd starts jobs for users and needs root" >&2; exit 2; }
for tool in munged slurmctld slurmd sbatch; do
    command -v "$tool" >/dev/null || { echo "$tool is missing: install Debian's slurmctld, slurmd, slurm-client and munge" >&2; exit 2; }
done

work=$(mktemp -d)
pids=()
stop() {
    trap - EXIT
    # only what this script started
    for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
    for pid in "${pids[@]}"; do wait "$pid" 2>/dev/null || true; done
    rm -rf "$work"
}
trap stop EXIT

node=$(hostname -s)
mkdir -p "$work"/{munge,ctld,d,log}
chmod 755 "$work"
chmod 700 "$work/munge"
head -c 1024 /dev/urandom > "$work/munge/key"
chmod 400 "$work/munge/key"
cat > "$work/slurm.conf" <<CONF
ClusterName=brakewave
SlurmctldHost=$node(127.0.0.1)
SlurmctldPort=26817
SlurmdPort=26818
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$work/munge.socket
CredType=cred/munge
StateSaveLocation=$work/ctld
SlurmdSpoolDir=$work/d
SlurmctldPidFile=$work/ctld.pid
SlurmdPidFile=$work/d.pid
SlurmctldLogFile=$work/log/slurmctld
SlurmdLogFile=$work/log/slurmd
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
ReturnToService=2
NodeName=$node NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$node Default=YES State=UP
CONF
# processes are tracked through /proc; before version 23 the plugin cannot be disabled, but the one
# for cgroup v1 does nothing unless it is used
version=$(slurmd -V | grep -o '[0-9]*' | head -1)
if ((version >= 23)); then echo "CgroupPlugin=disabled"; else echo "CgroupPlugin=cgroup/v1"; fi > "$work/cgroup.conf"
export SLURM_CONF=$work/slurm.conf

munged --foreground --force --key-file="$work/munge/key" --socket="$work/munge.socket" \
    --pid-file="$work/munge/pid" --log-file="$work/log/munged" --seed-file="$work/munge/seed" \
    >"$work/log/munged.out" 2>&1 &
pids+=($!)
for _ in $(seq 50); do [[ -S $work/munge.socket ]] && break; sleep 0.1; done
slurmctld -D -f "$SLURM_CONF" >"$work/log/slurmctld.out" 2>&1 &
pids+=($!)
slurmd -D -f "$SLURM_CONF" -N "$node" >"$work/log/slurmd.out" 2>&1 &
pids+=($!)
for _ in $(seq 100); do
    [[ $(sinfo -h -o %t 2>/dev/null) == idle ]] && break
    sleep 0.2
done
if [[ $(sinfo -h -o %t 2>/dev/null) != idle ]]; then
    echo "the node does not come up:" >&2
    tail -n 20 "$work"/log/* >&2
    exit 3
fi
sinfo

out=$work/map
mkdir "$out"
submit=(sbatch --parsable --output="$work/log/job-%a" --array="1-$shards")
export BRAKEWAVE=$brakewave PROBLEM=$problem OUT=$out
job=$("${submit[@]}" --chdir="$work" "$here/map.sbatch")
joined=$(sbatch --parsable --output="$work/log/merge" --chdir="$work" --dependency="afterok:$job" \
    --wrap="$brakewave map merge $out/shard-* --out $out/joined")
echo "array $job of $shards shards, then $joined joins them"
while [[ -n $(squeue -h -j "$job,$joined" 2>/dev/null) ]]; do
    squeue -h -o "%i %T %r"
    sleep 2
done
cat "$work"/log/job-* "$work/log/merge"

"$brakewave" map "$problem" --out "$work/whole" --quiet
for name in map.csv map.parquet; do
    [[ -e $work/whole/$name ]] || continue
    cmp "$work/whole/$name" "$out/joined/$name"
    echo "$name of $shards shards is that of one run: $(sha256sum < "$out/joined/$name" | cut -c1-16)"
done
