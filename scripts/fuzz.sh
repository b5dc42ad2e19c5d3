#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
# fuzz.sh [--minutes N] [--jobs N] [TARGET...]: builds the fuzz targets with clang, its sanitizers and libFuzzer (--jobs:
# parallel compilers), and runs them one after the other for N minutes in total (default 1). New inputs are kept in
# build/fuzz/corpus, failing inputs as build/fuzz/TARGET-*, logs as build/fuzz/TARGET.log. A finding ends its target but not
# the others; the script then fails. Prints a table at the end: executions, edges, processor time.
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

minutes=1
jobs=$(jobs)
targets=()
while [ $# -gt 0 ]; do
  case $1 in
    --minutes) [ $# -ge 2 ] || die "--minutes needs a number"; minutes=$2; shift 2 ;;
    --jobs) [ $# -ge 2 ] || die "--jobs needs a number"; jobs=$2; shift 2 ;;
    -h | --help) sed -n '4,7s/^# //p' "${BASH_SOURCE[0]}"; exit 0 ;;
    -*) die "unknown option $1; see --help" ;;
    *) targets+=("$1"); shift ;;
  esac
done
install_packages "${build_packages[@]}" clang-14 libclang-rt-14-dev ccache
cd "$root"
if [ ${#targets[@]} -eq 0 ]; then
  for source in fuzz/fuzz_*.cpp; do
    name=$(basename "$source" .cpp)
    targets+=("${name#fuzz_}")
  done
fi
say "Building the fuzz targets"
cmake --preset fuzz >"$log" 2>&1 || die "cannot configure; see $log"
cmake --build build/fuzz -j "$jobs" --target "${targets[@]/#/fuzz_}" || die "cannot build; see above"

# last KEY LOG: the last number behind KEY.
last() { grep -oE "$1 *[0-9]+" "$2" | tail -n 1 | grep -oE '[0-9]+$' || echo 0; }

seconds=$((minutes * 60 / ${#targets[@]}))
found=()
rows=()
TIMEFORMAT='%U'
for target in "${targets[@]}"; do
  say "$target for $seconds s"
  mkdir -p "build/fuzz/corpus/$target"
  said=build/fuzz/$target.log
  # One input may take two minutes by the clock: the machine may be busy with other work.
  cpu=$({ time "build/fuzz/fuzz/fuzz_$target" -max_total_time="$seconds" -timeout=120 -rss_limit_mb=4096 -print_final_stats=1 \
    -artifact_prefix="build/fuzz/$target-" "build/fuzz/corpus/$target" "fuzz/corpus/$target" >"$said" 2>&1 ||
    echo failed >"$said.failed"; } 2>&1)
  if [ -e "$said.failed" ]; then
    rm "$said.failed"
    found+=("$target")
    tail -n 40 "$said"
  fi
  rows+=("| \`$target\` | $(last stat::number_of_executed_units: "$said") | $(last 'cov:' "$said") | ${cpu%.*} |")
  echo "${rows[-1]}"
done
printf '\n| target | executions | edges reached | processor seconds |\n| --- | ---: | ---: | ---: |\n'
printf '%s\n' "${rows[@]}"
[ ${#found[@]} -eq 0 ] || die "found something: ${found[*]}" "the inputs are build/fuzz/TARGET-*"
echo "no finding"
