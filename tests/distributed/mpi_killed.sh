#!/bin/sh
# SPDX-License-Identifier: MIT
#
# A rank that is killed ends the whole run, with an exit code and without a half-written file:
# mpi_killed.sh ALCAP ALCAP_MPI MPIRUN WORK
alcap=$1 alcap_mpi=$2 mpirun=$3 work=$4
rm -rf "$work" && mkdir -p "$work" && cd "$work" || exit 1
"$alcap" make scan:6 -o mesh.ply -q || exit 1
"$mpirun" -n 3 "$alcap_mpi" field mesh.ply -n 4 -o out >log 2>&1 &
run=$!
ranks=
tries=0
# The ranks are children of mpirun. One that has its name set is past its start.
while [ "$(echo "$ranks" | wc -w)" -lt 3 ]; do
  tries=$((tries + 1))
  [ $tries -le 300 ] || { echo "the ranks did not start"; cat log; kill $run; exit 1; }
  sleep 0.1
  kill -0 $run 2>/dev/null || { echo "the run was over before a rank could be killed"; cat log; exit 1; }
  ranks=
  for child in $(cat /proc/$run/task/$run/children); do
    [ "$(cat /proc/$child/comm)" = "$(basename "$alcap_mpi")" ] && ranks="$ranks $child"
  done
done
sleep 0.5
set -- $ranks
kill -9 "$2" || exit 1
wait $run
code=$?
echo "mpirun left with exit code $code"
[ $code -ne 0 ] || { echo "the run went on"; exit 1; }
[ ! -e out/field.ply ] || { echo "there is a file"; exit 1; }
# mpirun may leave before the last rank has.
for rank in $ranks; do
  tries=0
  while [ -e /proc/$rank ] && [ "$(cut -d' ' -f3 /proc/$rank/stat 2>/dev/null)" != Z ]; do
    tries=$((tries + 1))
    [ $tries -le 100 ] || { echo "rank $rank goes on"; exit 1; }
    sleep 0.1
  done
done
