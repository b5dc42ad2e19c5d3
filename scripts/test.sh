#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
# test.sh [--preset NAME] [ctest options]: installs missing packages, builds everything, and runs every test.
# Presets: release (default), dev, asan, tsan, ci. Example: scripts/test.sh --preset asan -R mesh
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

preset=release
while [ $# -gt 0 ]; do
  case $1 in
    --preset) [ $# -ge 2 ] || die "--preset needs a name"; preset=$2; shift 2 ;;
    -h | --help) sed -n '4,5s/^# //p' "${BASH_SOURCE[0]}"; exit 0 ;;
    *) break ;;
  esac
done

# The Python package and the leaks of the C interface have tests of their own, skipped where these cannot be had.
try_install valgrind || say "WARNING: the C interface will not be checked for leaks: $why"
try_install abigail-tools || say "WARNING: the binary interface of the C library will be compared only by functions and sizes: $why"
try_install "${python_packages[@]}" || say "WARNING: the Python package will not be built and tested: $why"
try_install "${notebook_packages[@]}" || say "WARNING: the notebooks will not be run in a kernel: $why"
# VTK reads our VTP files back. It is large, so a machine that cannot have it skips that one test, and says so.
if ! install_with python3-vtk9 "${build_packages[@]}" ccache pkg-config; then
  say "WARNING: the test that reads our VTP files back with VTK will be skipped: $why"
fi
build "$preset"

say "Running the tests"
cd "$root/build/$preset"
ctest --output-on-failure --no-tests=error -j "$(nproc)" "$@" || die "some tests failed; their output is above." \
  "Run one again with: scripts/test.sh --preset $preset -R NAME"
