#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
# sanitize.sh [asan|tsan|valgrind|quick] [ctest options]: runs the tests with the address, undefined-behaviour and float-cast
# sanitizers (asan), the concurrent tests with the thread sanitizer (tsan), or the vectorised loops under valgrind. quick:
# only meshes and their readers, as asan. docs/reliability.md says what is left out, and why.
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

what=asan
case ${1:-} in
  asan | tsan | valgrind | quick) what=$1; shift ;;
  -h | --help) sed -n '4,6s/^# //p' "${BASH_SOURCE[0]}"; exit 0 ;;
esac
install_packages "${build_packages[@]}" ccache
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

if [ "$what" = quick ]; then
  # What these programs call of the library is a quarter of it, and the rest is not compiled: they are linked by hand.
  folder=build/quick flags=(-fsanitize=address,undefined,float-cast-overflow)
  cmake --preset asan -B "$folder" -DCMAKE_CXX_FLAGS_DEBUG='-O0 -g1' -DALCAP_BUILD_APPS=OFF -DALCAP_BUILD_C=OFF \
    -DALCAP_BUILD_FUZZ=ON -DALCAP_BUILD_PYTHON=OFF -DALCAP_BUILD_EXAMPLES=OFF >"$log" 2>&1 || die "cannot configure; see $log"
  # objects PATTERN: the object files whose names are so.
  objects() { ninja -C "$folder" -t targets all | sed -n 's/: CXX_COMPILER.*//p' | grep -E "$1"; }
  mapfile -t library < <(objects '^CMakeFiles/alcap.dir/(src/simd/|src/mesh/|Unity/unity_src_(base|mesh|io_mesh)_)')
  mapfile -t mesh < <(objects '^tests/CMakeFiles/(test_mesh|alcap_doctest_main)[.]dir/.*[.]cpp[.]o')
  mapfile -t reader < <(objects '^fuzz/CMakeFiles/fuzz_mesh_file[.]dir/')
  say "Building"
  cmake --build "$folder" -j "$(jobs)" --target "${library[@]}" "${mesh[@]}" "${reader[@]}" || die "the build failed"
  (cd "$folder" && c++ "${flags[@]}" "${mesh[@]}" "${library[@]}" -o mesh -ltbb &&
    c++ "${flags[@]}" "${reader[@]}" "${library[@]}" -o reader -ltbb) || die "they do not link"
  export UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1
  say "Meshes"
  "$folder/mesh" || die "a test failed"
  say "Readers, 20 seconds"
  mkdir -p "$folder/found"
  "$folder/reader" -max_total_time=20 -seed=2 -artifact_prefix="$folder/" "$folder/found" fuzz/corpus/mesh_file ||
    die "a reader failed; the input is $folder/crash"
  exit 0
fi

case $what in
  asan)
    install_packages clang-14 libclang-rt-14-dev
    preset=fuzz  # one build by clang serves the fuzz targets as well
    targets=(test_{base,mesh,kernels,io,connection,energy,solvers,field,curves,run,design,faults,cli,c})
    for source in fuzz/fuzz_*.cpp; do targets+=("$(basename "$source" .cpp)"); done
    # Left out: pages in a browser, projects that build the library once more, documents, and what other programs read.
    chosen=(-E '^(browser|consumer_.*|default_build.*|docs_.*|.*_script|bench_scripts|readme_.*|cli_.*_read_back|output_vtk)$')
    ;;
  tsan)
    install_packages python3
    preset=tsan
    targets=(test_{base,connection,solvers,run} alcap_cli)
    chosen=(-R '^(array|connected_surface|registry|solve|multigrid|solver_stops|batch|cancel|same_bits|studio_faults)$')
    ;;
esac
build "$preset" "${targets[@]}"
say "Running the tests"
cd "build/$preset"
# For what CTest gives no environment of its own: the studio.
export TSAN_OPTIONS="suppressions=$root/tests/support/tsan.supp history_size=7 halt_on_error=1"
ctest --output-on-failure --no-tests=error -j "$(nproc)" "${chosen[@]}" "$@" || die "some tests failed; their output is above."
