#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
# portable.sh [--quick] [ctest options]: builds with ALCAP_PORTABLE, in build/portable, what other systems get: no POSIX
# files, no signals, no pictures, no studio. Checks that no such call is left, and runs the test suite there, without the
# tests of those things, which it names. --quick: some tests of files and the tool alone.
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

# Tests of what such a build does not have, and why they are not run. Single cases say so themselves (tests/support/portable.h):
# pipes, signals, a bound of memory, what a killed run leaves.
declare -A left_out=(
  [browser]='no studio'
  [studio_faults]='no studio'
  [python_package]='built without Python'
  [consumer_subdirectory]='builds the library anew, without ALCAP_PORTABLE'
  [consumer_fetch_content]='builds the library anew, without ALCAP_PORTABLE'
  [default_build_is_optimised]='builds the library anew, without ALCAP_PORTABLE'
)
programs=(all) chosen=(.)
case ${1:-} in
  --quick)
    programs=(alcap_cli test_base test_io)
    chosen=('^(array|numbers|names|mesh_io|output|element_tables|handoff|matrix_file|edge_lengths)$')
    shift
    ;;
  -h | --help) sed -n '4,7s/^# //p' "${BASH_SOURCE[0]}"; exit 0 ;;
esac
install_packages "${build_packages[@]}"
folder=$root/build/portable
cmake -S "$root" -B "$folder" -G Ninja -DALCAP_PORTABLE=ON -DCMAKE_BUILD_TYPE=Release -DALCAP_WARNINGS_AS_ERRORS=ON \
  -DALCAP_BUILD_C=OFF -DALCAP_BUILD_PYTHON=OFF -DALCAP_BUILD_EXAMPLES=OFF -DALCAP_WITH_PETSC=OFF >"$log" 2>&1 ||
  { tail -n 20 "$log" >&2; die "CMake could not configure"; }
cmake --build "$folder" -j "$(jobs)" --target "${programs[@]}"

say "No call of the system is left in the library"
calls=$(nm -C --undefined-only "$folder/libalcap.a" | awk '{ print $NF }' |
  grep -xE 'open|open64|fsync|flock|fstat|fstat64|mmap|mmap64|sigaction|signal|fork|kill|poll|dlsym|isatty|usleep|mkstemp|getrlimit' | sort -u || true)
[ -z "$calls" ] || die "libalcap.a calls" $calls
! nm --undefined-only "$folder"/apps/alcap/alcap | grep -E ' (sigaction|signal|dlsym|mmap|eglInitialize)(@|$)' ||
  die "the tool calls what the lines above say"

say "Tests"
for name in "${!left_out[@]}"; do echo "   left out: $name (${left_out[$name]})"; done
without=$(IFS='|'; echo "${!left_out[*]}")
(cd "$folder" && ctest -R "${chosen[0]}" ${without:+-E "^($without)\$"} --output-on-failure --no-tests=error -j "$(nproc)" "$@")
try=$(mktemp -d)
trap 'rm -rf "$try"' EXIT
cd "$try"
"$folder/apps/alcap/alcap" make icosphere:3 -o ball.ply -q
"$folder/apps/alcap/alcap" field ball.ply -n 4 -o out --json >out.json
grep -q '"ok": true' out.json || die "the tool made no field"
[ -s out/field.ply ] && [ -s out/report.json ] || die "the tool wrote no files"
! "$folder/apps/alcap/alcap" studio 2>/dev/null || die "there is a studio"
say "The portable build works"
