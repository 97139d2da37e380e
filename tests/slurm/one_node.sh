#!/bin/bash
# Run a command on a Slurm cluster that is this machine alone, and end the cluster with it.
#   sudo apt-get install slurm-wlm munge
#   sudo tests/slurm/one_node.sh .venv/bin/python sim/collect.py --multirun hydra/launcher=submitit_slurm ...
# Needs root, because slurmd does. Nothing outside a temporary folder is changed but munge's socket in /run/munge.
set -euo pipefail

if [ $# -eq 0 ]; then
    sed -n '2,5s/^# \?//p' "$0"
    exit 2
fi
for program in slurmctld slurmd munged sbatch; do
    command -v "$program" > /dev/null || { echo "$program is missing: apt-get install slurm-wlm munge" >&2; exit 2; }
done

folder=$(mktemp -d /tmp/one_node.XXXXXX)
mkdir "$folder/state" "$folder/spool"
export SLURM_CONF="$folder/slurm.conf"
host=$(hostname -s)
cat > "$SLURM_CONF" << END
ClusterName=one
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
CryptoType=crypto/munge
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
# no cgroups, which containers often lack
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=2,bf_interval=2
MpiDefault=none
DefMemPerCPU=1000
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) RealMemory=$(free --mebi | awk '/^Mem:/ {print $2}') State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
END

pids=()
end() {
    scancel --user="$(id -un)" 2> /dev/null || true
    # what is left of a job would trouble the next cluster on the same ports
    for _ in $(seq 60); do
        pgrep slurmstepd > /dev/null || break
        sleep 1
    done
    kill "${pids[@]}" 2> /dev/null || true
    wait "${pids[@]}" 2> /dev/null || true
    if [ "${status:-1}" -eq 0 ]; then rm -rf "$folder"; else echo "The cluster's logs: $folder" >&2; fi
}
trap end EXIT

if ! munge --no-input > /dev/null 2>&1; then
    install -d -o munge -g munge /run/munge
    setpriv --reuid=munge --regid=munge --clear-groups munged --foreground > "$folder/munged.log" 2>&1 & pids+=($!)
fi
slurmctld -D > /dev/null 2>&1 & pids+=($!)
slurmd -D > /dev/null 2>&1 & pids+=($!)
for _ in $(seq 30); do
    [ "$(sinfo --noheader --format=%t 2> /dev/null)" = idle ] && break
    sleep 1
done
sinfo

status=0
"$@" || status=$?
exit "$status"
