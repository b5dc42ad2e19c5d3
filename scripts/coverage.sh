#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
# coverage.sh [--throws] [ctest options]: measures line coverage per folder with gcov. Builds the preset coverage and runs its
# tests (by default quick and medium). --throws also lists the statements that throw and were not run.
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

throws=()
if [ "${1:-}" = --throws ]; then
  throws=(--throws)
  shift
fi
if [ "${1:-}" = -h ] || [ "${1:-}" = --help ]; then
  sed -n '4,5s/^# //p' "${BASH_SOURCE[0]}"
  exit 0
fi
[ $# -gt 0 ] || set -- -L "quick|medium"
install_packages "${build_packages[@]}" python3 ccache
build coverage
find "$root/build/coverage" -name '*.gcda' -delete

say "Running the tests"
cd "$root/build/coverage"
ctest --no-tests=error -j "$(nproc)" "$@" || echo "   some tests failed; what they ran counts all the same"
say "Lines that were run"
python3 -B "$root/scripts/coverage.py" "$root/build/coverage" "$root" ${throws[@]+"${throws[@]}"}
