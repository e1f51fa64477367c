# shellcheck shell=bash
# A cluster of four nodes on this machine, with Debian's Slurm: munged, slurmctld and four slurmd with names of their own,
# all of them in one scratch folder and on loopback. Needs root, as Debian's packages are built. To be sourced.
#   start_slurm FOLDER      afterwards SLURM_CONF is exported, and sinfo, sbatch, … speak to it
#   stop_slurm FOLDER
# Slurm lets a job that was requeued wait until its credential has expired, 121 s: here it does after 5.
# Ports follow from the process, so that two of them do not meet.

start_slurm() { # FOLDER
    local folder=$1 host base
    host=$(hostname -s)
    base=$((20000 + $$ % 4000 * 10))
    mkdir -p "$folder"/{state,spool,log,run,munge} && chmod 755 "$folder" "$folder"/{state,spool,log,run} && chmod 700 "$folder/munge"
    head -c 1024 /dev/urandom >"$folder/munge/key" && chmod 400 "$folder/munge/key"
    munged --key-file="$folder/munge/key" --socket="$folder/run/munge.sock" --pid-file="$folder/run/munged.pid" \
        --log-file="$folder/log/munged.log" --seed-file="$folder/munge/seed" --num-threads=2 --force 2>"$folder/log/munged.out" || return 1
    cat >"$folder/slurm.conf" <<CONF
ClusterName=abbe
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/run/munge.sock,cred_expire=5
CredType=cred/munge
SlurmctldPort=$base
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool/%n
SlurmctldPidFile=$folder/run/ctld.pid
SlurmdPidFile=$folder/run/%n.pid
SlurmctldLogFile=$folder/log/ctld.log
SlurmdLogFile=$folder/log/%n.log
ReturnToService=2
SlurmdTimeout=15
KillWait=10
MinJobAge=300
SlurmdParameters=config_overrides
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=1,bf_interval=1,sched_min_interval=100000,batch_sched_delay=0
NodeName=n[1-4] NodeHostname=$host NodeAddr=127.0.0.1 Port=[$((base + 1))-$((base + 4))] CPUs=1 State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
    export SLURM_CONF=$folder/slurm.conf
    slurmctld -c -f "$SLURM_CONF" || return 1
    local n
    for n in 1 2 3 4; do mkdir -p "$folder/spool/n$n" && slurmd -f "$SLURM_CONF" -N "n$n" || return 1; done
    for ((n = 0; n < 300; n++)); do
        [[ $(sinfo --noheader --format=%D --states=idle 2>/dev/null) == 4 ]] && return 0
        sleep 0.1
    done
    sinfo
    return 1
}

stop_slurm() { # FOLDER
    local file
    for file in "$1"/run/*.pid; do
        [[ -s $file ]] && kill "$(cat "$file")" 2>/dev/null
    done
    return 0
}
