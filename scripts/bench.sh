#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
# bench.sh [--quick|--full] [--minutes N] [--sizes LIST] [--threads LIST] [--out FOLDER] [--no-build]: builds the
# benchmarks and the tool in build/bench, runs them, and writes JSON, tables (Markdown, CSV) and plots (SVG) into FOLDER
# (default out/bench). --quick: up to 1.31 million triangles (the default). --full: up to 21 million, five repetitions,
# first the table of targets at all sizes, then all families from small to large. --minutes: the time limit of the run,
# without building (default 3, with --full 360). Sizes are triangles, such as 50000,327680. Needs only python3.
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

mode=quick minutes='' sizes='' threads='' out=$root/out/bench compile=yes
while [ $# -gt 0 ]; do
  case $1 in
    --quick | --full) mode=${1#--} ;;
    --minutes | --sizes | --threads | --out)
      [ $# -ge 2 ] || die "$1 needs a value."
      declare "${1#--}=$2"
      shift
      ;;
    --no-build) compile=no ;;
    -h | --help) sed -n '4,8s/^# //p' "${BASH_SOURCE[0]}"; exit 0 ;;
    *) die "unknown option $1; see bench.sh --help." ;;
  esac
  shift
done

if [ "$compile" = yes ]; then
  install_packages "${build_packages[@]}" libbenchmark-dev python3
  say "Building into build/bench"
  cmake -S "$root" -B "$root/build/bench" -G Ninja -DCMAKE_BUILD_TYPE=Release -DALCAP_BUILD_PERF=ON \
    -DALCAP_BUILD_TESTS=OFF >"$log" 2>&1 || die "configuring failed" "see $log"
  ninja -C "$root/build/bench" alcap_perf alcap_cli >"$log" 2>&1 || die "building failed" "see $log"
fi
mkdir -p "$out"
exec python3 "$root/scripts/bench_run.py" --build "$root/build/bench" --out "$out" --mode "$mode" \
  ${minutes:+--minutes "$minutes"} ${sizes:+--sizes "$sizes"} ${threads:+--threads "$threads"}
