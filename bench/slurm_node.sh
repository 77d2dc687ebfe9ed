#!/usr/bin/env bash
# bench/slurm_node.sh PROGRAM: a Slurm of one node on this machine, as root, and the job scripts of
# docs/examples/cluster on it. Their tables must have the bytes of one process.
# Needs Debian's slurmctld, slurmd, slurm-client and munge; daemons and files are gone at the end.
set -euo pipefail
program=$(realpath "$1")
cd "$(dirname "$0")/.."
[ "$(id -u)" -eq 0 ] || { echo "needs root: slurmd runs jobs as their users" >&2; exit 2; }
place=$(mktemp -d /tmp/impactdic-slurm.XXXXXX)
chmod 755 "$place"
pids=()
finish() {
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
  for pid in "${pids[@]}"; do wait "$pid" 2>/dev/null || true; done
  rm -rf "$place"
}
trap finish EXIT

mkdir -p "$place"/{munge,state,spool} && chmod 700 "$place/munge"
dd if=/dev/urandom of="$place/munge/key" bs=1 count=1024 status=none
chmod 600 "$place/munge/key"
munged --foreground --force --socket="$place/munge.socket" --key-file="$place/munge/key" \
  --pid-file="$place/munge/pid" --seed-file="$place/munge/seed" --log-file="$place/munge/log" &
pids+=($!)
node=$(hostname -s)
cat > "$place/slurm.conf" <<CONF
ClusterName=one
SlurmctldHost=$node
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$place/munge.socket
CredType=cred/munge
StateSaveLocation=$place/state
SlurmdSpoolDir=$place/spool
SlurmctldPidFile=$place/slurmctld.pid
SlurmdPidFile=$place/slurmd.pid
SlurmctldLogFile=$place/slurmctld.log
SlurmdLogFile=$place/slurmd.log
SlurmctldPort=16817
SlurmdPort=16818
ProctrackType=proctrack/pgid
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
ReturnToService=2
NodeName=$node CPUs=8 RealMemory=1000 State=UNKNOWN
PartitionName=work Nodes=ALL Default=YES MaxTime=60 State=UP
SlurmdParameters=config_overrides
CONF
export SLURM_CONF=$place/slurm.conf
sleep 1
slurmctld -D & pids+=($!)
slurmd -D & pids+=($!)
for _ in $(seq 60); do
  sinfo -h -o %t 2>/dev/null | grep -q idle && break
  sleep 1
done
sinfo

clips=$place/clips
mkdir "$clips"
for i in 1 2 3 4 5 6 7 8; do
  "$program" synth --size 128x128 --radius-px 36 --frames 6 --pattern e1 --velocity-px 1,0.5 \
    --seed $i -q -o "$place/made"
  mv "$place/made/video.tif" "$clips/shot_$i.tif" && rm -r "$place/made"
done
echo "this is no clip" > "$clips/shot_9.cine"
options=(--fps 10000 --ball-diameter-mm 67)
"$program" batch "$clips" -o "$place/alone" -q "${options[@]}" 2>/dev/null

export IMPACTDIC=$program
scripts=$PWD/docs/examples/cluster
wrong=0
check() {  # NAME: its tables against those of one process
  local table
  for table in shots.csv shots/shot_{1,2,3,4,5,6,7,8}/track.csv; do
    cmp "$place/alone/$table" "$place/$1/$table" || wrong=1
  done
  [ "$(ls "$place/$1/shots" | wc -l)" -eq 8 ] || { echo "$1: other shots"; wrong=1; }
  [ $wrong -eq 0 ] && echo "$1: the bytes of one process"
}
cd "$place"
limits=(--cpus-per-task=1 --time=10 --wait --output "$place/%x-%j.log")
sbatch "${limits[@]}" --array=1-3 "$scripts/shards.sbatch" "$clips" "$place/array" "${options[@]}"
check array
sbatch "${limits[@]}" --ntasks=3 "$scripts/ranks.sbatch" "$clips" "$place/srun" "${options[@]}"
check srun
# One rank of three killed: the job goes on.
sbatch "${limits[@]}" --ntasks=3 "$scripts/ranks.sbatch" "$clips" "$place/killed" "${options[@]}" &
job=$!
for _ in $(seq 300); do
  victim=$(pgrep -n -f "^$program batch $clips -o $place/killed" || true)
  [ -n "$victim" ] && [ "$(ls "$place/killed/shots" 2>/dev/null | wc -l)" -gt 1 ] && break
  sleep 0.1
done
kill -9 "$victim"
wait $job || true  # a rank ended badly, and Slurm says so
check killed
[ $wrong -eq 0 ] || { tail -n 20 "$place"/*.log; exit 1; }
