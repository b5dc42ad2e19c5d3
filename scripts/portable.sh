#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
# portable.sh [--quick] [ctest options]: builds the configuration for other systems (ALCAP_PORTABLE) in build/portable: no
# POSIX files, no signals, no pictures, no studio. Checks that no such calls remain, and runs the test suite except for the
# tests of these features, which it lists. --quick: runs only some tests of files and of the tool.
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

# Tests of features that this build does not have, and why they are not run. Single cases skip themselves (tests/support/portable.h):
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

say "Checking that the library makes no system calls"
calls=$(nm -C --undefined-only "$folder/libalcap.a" | awk '{ print $NF }' |
  grep -xE 'open|open64|fsync|flock|fstat|fstat64|mmap|mmap64|sigaction|signal|fork|kill|poll|dlsym|isatty|usleep|mkstemp|getrlimit' | sort -u || true)
[ -z "$calls" ] || die "libalcap.a calls" $calls
! nm --undefined-only "$folder"/apps/alcap/alcap | grep -E ' (sigaction|signal|dlsym|mmap|eglInitialize)(@|$)' ||
  die "the tool makes the system calls listed above"

say "Tests"
for name in "${!left_out[@]}"; do echo "   left out: $name (${left_out[$name]})"; done
without=$(IFS='|'; echo "${!left_out[*]}")
(cd "$folder" && ctest -R "${chosen[0]}" ${without:+-E "^($without)\$"} --output-on-failure --no-tests=error -j "$(nproc)" "$@")
try=$(mktemp -d)
trap 'rm -rf "$try"' EXIT
cd "$try"
"$folder/apps/alcap/alcap" make icosphere:3 -o ball.ply -q
"$folder/apps/alcap/alcap" field ball.ply -n 4 -o out --json >out.json
grep -q '"ok": true' out.json || die "the tool computed no field"
[ -s out/field.ply ] && [ -s out/report.json ] || die "the tool wrote no files"
! "$folder/apps/alcap/alcap" studio 2>/dev/null || die "the studio should not exist in this build"
say "The portable build works"
