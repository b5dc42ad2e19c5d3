#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
# faults.sh [allocations|calls|kills]: injects faults everywhere, where the tests do so at a few dozen places: makes every
# allocation of small runs fail, every system call fail, and kills 200 runs at random times. Takes about half an hour.
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

case ${1:-all} in
  -h | --help) sed -n '4,5s/^# //p' "${BASH_SOURCE[0]}"; exit 0 ;;
  all | allocations | calls | kills) what=${1:-all} ;;
  *) die "unknown: $1 (allocations, calls or kills)" ;;
esac
preset=${ALCAP_PRESET:-release}
install_packages "${build_packages[@]}" ccache
build "$preset" test_faults test_cli
cd "$root/build/$preset/tests"
if [ "$what" = all ] || [ "$what" = kills ]; then
  say "200 runs that are killed"
  ALCAP_KILLS=200 ./test_cli --source-file='*test_cli_injected.cpp' --test-case='killed at random*' --success=false
fi
if [ "$what" = all ] || [ "$what" = allocations ]; then
  say "Every allocation"
  ALCAP_EVERY_ALLOCATION=1 ./test_faults --source-file='*test_allocations.cpp'
fi
if [ "$what" = all ] || [ "$what" = calls ]; then
  say "Every call of the system, and every seventh allocation of the tool"
  ALCAP_EVERY_FAULT=1 ./test_cli --source-file='*test_cli_injected.cpp'
fi
