#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
# index64.sh [--all] [ctest options]: builds alcap with 64-bit indices (ALCAP_INDEX_64) in build/index64 and runs its quick and
# medium tests (--all: all of them). Checks that its tool writes the same bytes as that of build/release (preset ALCAP_PRESET): fields,
# curves, tables, meshes, matrices and designs; that both packages can be installed side by side; and that options which need
# 32 bits are refused.
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

chosen=(-L "quick|medium")
case ${1:-} in
  --all) chosen=() && shift ;;
  -h | --help) sed -n '4,8s/^# //p' "${BASH_SOURCE[0]}"; exit 0 ;;
esac
install_packages "${build_packages[@]}"
folder=$root/build/index64
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
perf=OFF
[ -n "$(missing_packages libbenchmark-dev)" ] || perf=ON

# configure FOLDER OPTIONS...: alcap64, optimised as the release: other flags round differently.
configure() {
  local into=$1
  shift
  cmake -S "$root" -B "$into" -G Ninja -DALCAP_INDEX_64=ON -DCMAKE_BUILD_TYPE=Release -DALCAP_WARNINGS_AS_ERRORS=ON \
    -DALCAP_BUILD_PERF=$perf "$@" >"$log" 2>&1
}

say "Options that need 32 bits"
for option in ALCAP_BUILD_C ALCAP_BUILD_PYTHON ALCAP_WITH_PETSC; do
  ! configure "$work/refused" "-D$option=ON" || die "$option=ON should be refused"
  grep -q "alcap: $option is ON" "$log" || die "$option=ON was refused for another reason; see $log"
  rm -rf "$work/refused"
  echo "   $option: refused"
done

say "Building alcap64"
configure "$folder" || { tail -n 20 "$log" >&2; die "CMake could not configure"; }
cmake --build "$folder" -j "$(jobs)"
build "${ALCAP_PRESET:-release}" alcap alcap_cli
narrow=$root/build/${ALCAP_PRESET:-release}/apps/alcap/alcap
wide=$folder/apps/alcap/alcap

say "Tests"
(cd "$folder" && ctest "${chosen[@]}" --output-on-failure --no-tests=error -j "$(jobs)" "$@")

# both NAME COMMAND...: runs it with both tools, in a folder for each. Both end with the same exit code and leave the same
# files with the same bytes, apart from reports, which have times.
files=0
both() {
  local name=$1 code
  shift
  for width in narrow wide; do
    mkdir -p "$work/$width/$name"
    code=0
    (cd "$work/$width/$name" && "${!width}" "$@" -q >/dev/null 2>message) || code=$?
    case $code in 0 | 5 | 8) ;; *) cat "$work/$width/$name/message" >&2; die "$name: exit code $code" ;; esac
    echo "exit code $code" >>"$work/$width/$name/message"
    rm -f "$work/$width/$name"/{,*/}report.json
  done
  diff -rq "$work/narrow/$name" "$work/wide/$name" || die "$name: the builds write different bytes"
  files=$((files + $(find "$work/wide/$name" -type f ! -name message | wc -l)))
}
say "The same bytes"
"$root/scripts/compare_fields.sh" "$narrow" "$wide"
printf '0 0 1\n0.5 0 1\n1 0.5 0.5\n' >"$work/stroke"
for shape in bumpy:4,0.3,4 scan:4,0.3 torus:60,30,1,0.4 genus:3,20 grid:30,20,3,2 disk:20 cylinder:40,20,1,3; do
  id=${shape%%:*}
  for extension in ply obj off; do both "$id.$extension" make "$shape" -o "mesh.$extension"; done
  mesh=$work/narrow/$id.ply/mesh.ply
  for n in 1 2 4; do
    both "$id-$n" field "$mesh" -n "$n" --formats ply,vtp,rawfield,rosy,csv,npy,dmat --curves curves.vtp -o out
    for format in petsc mtx npz; do both "$id-$n-$format" export-matrices "$mesh" -n "$n" --format $format -o matrices; done
  done
  both "$id-polar" field "$mesh" -n 2 --connection polar --formats ply,vtp -o out
  both "$id-design" design "$mesh" -n 2 --source 12 --stroke "$work/stroke" --formats ply,vtp -o out
  both "$id-ops" ops "$mesh" "$work/narrow/$id-4/out/field.ply" -o ops.vtp
done
echo "   $files files are the same"

say "Side by side"
cmake --install "$folder" --prefix "$work/prefix" >"$log"
cmake --install "$root/build/${ALCAP_PRESET:-release}" --prefix "$work/prefix" >"$log"
printf '#include <alcap/index.h>\nint main() { return 8 * sizeof(alcap::Index) == WIDTH ? 0 : 1; }\n' >"$work/main.cpp"
cat >"$work/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.25)
project(side_by_side CXX)
foreach(package IN LISTS PACKAGES)
  find_package(${package} REQUIRED)
endforeach()
add_executable(main main.cpp)
target_link_libraries(main PRIVATE alcap::alcap)
target_compile_definitions(main PRIVATE WIDTH=${WIDTH})
END
project() { cmake -S "$work" -B "$work/project" --fresh -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix" "$@" >"$log" 2>&1; }
for width in 32 64; do
  package=alcap
  [ $width = 32 ] || package=alcap64
  project -DPACKAGES=$package -DWIDTH=$width && cmake --build "$work/project" >"$log" && "$work/project/main" ||
    die "a project cannot use the package $package; see $log"
  echo "   $package: $width bits"
done
! project "-DPACKAGES=alcap;alcap64" -DWIDTH=64 || die "a project can use both packages, whose types differ"
tr -s ' \n' ' ' <"$log" | grep -q 'a project has one of alcap and alcap64' || die "both packages in one project fail in another way; see $log"
say "alcap64 works"
