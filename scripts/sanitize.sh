#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
# sanitize.sh [asan|tsan|valgrind] [--quick] [ctest options]: the tests under the sanitizers for addresses, undefined behaviour
# and casts of floating numbers (asan), or for threads (tsan: what several threads do at the same time), or the loops for packs
# under valgrind. --quick: the programs of a few folders alone. docs/reliability.md says what is left out, and why.
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

what=asan
quick=
while [ $# -gt 0 ]; do
  case $1 in
    asan | tsan | valgrind) what=$1; shift ;;
    --quick) quick=quick; shift ;;
    -h | --help) sed -n '4,6s/^# //p' "${BASH_SOURCE[0]}"; exit 0 ;;
    *) break ;;
  esac
done
install_packages "${build_packages[@]}" ccache python3 clang-14 libclang-rt-14-dev
cd "$root"

if [ "$what" = valgrind ]; then
  install_packages valgrind
  build "${ALCAP_PRESET:-release}" test_kernels
  say "The loops of src/simd under valgrind"
  # Valgrind knows packs up to AVX2; the program asks the processor, so AVX-512 is not tried. Quadrature is done in long
  # double, for which valgrind takes double: those references are not exact enough there.
  valgrind -q --error-exitcode=9 --leak-check=full --errors-for-leak-kinds=definite \
    "build/${ALCAP_PRESET:-release}/tests/test_kernels" --test-case-exclude='*quadrature*' \
    --source-file='*test_angles.cpp,*test_kernels_exp.cpp,*test_kernels_simd.cpp' "$@" || die "valgrind found something"
  exit 0
fi

# tests_of FOLDER...: a regular expression for the tests of these folders.
tests_of() {
  local folder source names=()
  for folder in "$@"; do
    for source in tests/"$folder"/test_*.cpp; do
      source=$(basename "$source" .cpp)
      names+=("${source#test_}")
    done
  done
  printf '^(%s)$' "$(IFS='|'; echo "${names[*]}")"
}

case $what$quick in
  asan)
    targets=(test_{base,mesh,kernels,io,connection,energy,solvers,field,curves,run,design,faults,cli,c})
    # Left out: pages in a browser, projects that build the library once more, documents, and what other programs read.
    chosen=(-E '^(browser|consumer_.*|default_build.*|docs_.*|.*_script|bench_scripts|readme_.*|cli_.*_read_back|output_vtk)$')
    ;;
  asanquick)
    targets=(test_{base,mesh,kernels,io})
    chosen=(-R "$(tests_of base mesh kernels io)")
    ;;
  tsan)
    targets=(test_{base,connection,solvers,run} alcap_cli)
    chosen=(-R '^(array|connected_surface|registry|solve|multigrid|solver_stops|batch|cancel|same_bits|studio_faults)$')
    ;;
  *)
    targets=(test_run)
    chosen=(-R '^(batch|same_bits)$')
    ;;
esac
# One build by clang serves the fuzz targets as well.
preset=$what
[ "$what" = tsan ] || preset=fuzz
build "$preset" "${targets[@]}"
say "Running the tests"
cd "build/$preset"
# For what CTest gives no environment of its own: the studio.
export TSAN_OPTIONS="suppressions=$root/tests/support/tsan.supp history_size=7 halt_on_error=1"
ctest --output-on-failure --no-tests=error -j "$(nproc)" "${chosen[@]}" "$@" || die "some tests failed; their output is above."
