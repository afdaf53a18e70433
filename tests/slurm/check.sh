#!/usr/bin/env bash
# A study as a Slurm array on a cluster of this one machine, which is begun for the check and ended with it: `ted study answers
# --slurm` hands two parts over, both finish, their scores join to one file, and the same again has nothing left to do.
# Needs the command `ted`, built, and Slurm: on Debian, apt-get install slurmctld slurmd slurm-client munge.
set -euo pipefail
cd "$(dirname "$0")/../.."
ted="$PWD/target/release/ted"
desk=$(mktemp -d)

finish() {
    local status=$?
    if [ "$status" -ne 0 ]; then
        tail -n 20 "$desk"/log/* "$desk"/runs/slurm/* >&2 2>/dev/null || true
    fi
    for daemon in slurmd slurmctld munged; do
        stop "$desk/$daemon.pid"
    done
    rm -rf "$desk"
}
trap finish EXIT

# Asks a daemon to end and waits until it has.
stop() {
    [ -s "$1" ] || return 0
    local process
    process=$(cat "$1")
    kill "$process" 2>/dev/null || return 0
    for _ in $(seq 100); do
        kill -0 "$process" 2>/dev/null || return 0
        sleep 0.1
    done
}

# Waits until a command succeeds.
until_it() {
    for _ in $(seq 300); do
        "$@" >/dev/null 2>&1 && return
        sleep 0.2
    done
    printf 'never came true: %s\n' "$*" >&2
    return 1
}

# A port that nobody listens at.
port() {
    python3 -c 'import socket; s = socket.socket(); s.bind(("", 0)); print(s.getsockname()[1])'
}

# All of it as whoever calls, in a folder of its own: nothing of the machine's own Slurm is touched.
begin_cluster() {
    PATH="$PATH:/usr/sbin:/sbin"
    mkdir -p "$desk/log" "$desk/state" "$desk/spool"
    # Munge wants its socket where everybody can reach it, and its key where nobody can.
    chmod 755 "$desk"
    head -c 1024 /dev/urandom >"$desk/munge.key"
    chmod 600 "$desk/munge.key"
    munged --key-file="$desk/munge.key" --socket="$desk/munge.socket" --pid-file="$desk/munged.pid" \
        --log-file="$desk/log/munged.log" --seed-file="$desk/munge.seed"
    local host user
    host=$(hostname -s)
    user=$(id -un)
    cat >"$desk/slurm.conf" <<END
ClusterName=check
SlurmctldHost=$host(localhost)
SlurmctldPort=$(port)
SlurmdPort=$(port)
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$desk/munge.socket
CredType=cred/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
StateSaveLocation=$desk/state
SlurmdSpoolDir=$desk/spool
SlurmctldPidFile=$desk/slurmctld.pid
SlurmdPidFile=$desk/slurmd.pid
SlurmctldLogFile=$desk/log/slurmctld.log
SlurmdLogFile=$desk/log/slurmd.log
NodeName=$host NodeAddr=localhost CPUs=$(nproc) RealMemory=1000 State=UNKNOWN
PartitionName=all Nodes=$host Default=YES State=UP
END
    export SLURM_CONF="$desk/slurm.conf"
    slurmctld
    slurmd
    until_it eval '[ "$(sinfo --noheader --format=%t)" = idle ]'
}

begin_cluster
cd "$desk"
export MINARI_DATASETS_PATH="$desk/data"
study=(study answers --families other --methods clone --set algorithm.steps=20 --set 'algorithm.hidden=[16]' --out runs --scores answers.jsonl)
"$ted" "${study[@]}" --slurm 2 --slurm-option=--time=10 | tee said
grep -q 'ted study merge answers.\*-of-2.jsonl --into answers.jsonl' said
until_it eval '[ -z "$(squeue --noheader)" ]'
for part in 1 2; do
    [ "$(wc -l <"answers.$part-of-2.jsonl")" -eq 3 ]
done
"$ted" study merge answers.*-of-2.jsonl --into answers.jsonl
[ "$(wc -l <answers.jsonl)" -eq 6 ]

# With the scores alone the table is there, and nothing is left to do.
rm -r runs data
"$ted" "${study[@]}" | grep 'toy-micrometres'
[ ! -e data ]

# What Slurm refuses is refused here, in its words.
if "$ted" "${study[@]}" --slurm 2 --slurm-option=--partition=none 2>refused; then
    exit 1
fi
grep -q 'sbatch refused: .*partition' refused
printf 'a study in two parts came back from Slurm whole\n'
