#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
# fuzz.sh [--minutes N] [TARGET...]: builds the fuzz targets with clang, its sanitizers and libFuzzer, and runs each for
# its share of the time (1 minute in all). What they find is kept in build/fuzz/corpus, a crash in build/fuzz.
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

minutes=1
targets=()
while [ $# -gt 0 ]; do
  case $1 in
    --minutes) [ $# -ge 2 ] || die "--minutes needs a number"; minutes=$2; shift 2 ;;
    -h | --help) sed -n '4,5s/^# //p' "${BASH_SOURCE[0]}"; exit 0 ;;
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
cmake --preset fuzz >/dev/null || die "cannot configure; see above"
cmake --build build/fuzz -j "$(nproc)" --target "${targets[@]/#/fuzz_}" || die "cannot build; see above"
seconds=$((minutes * 60 / ${#targets[@]}))
for target in "${targets[@]}"; do
  say "$target for $seconds s"
  mkdir -p "build/fuzz/corpus/$target"
  "build/fuzz/fuzz/fuzz_$target" -max_total_time="$seconds" -timeout=30 -rss_limit_mb=4096 -print_final_stats=1 \
    -artifact_prefix="build/fuzz/$target-" "build/fuzz/corpus/$target" "fuzz/corpus/$target" \
    || die "$target found something: build/fuzz/$target-*"
done
