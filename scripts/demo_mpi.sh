#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
# demo_mpi.sh [FOLDER] [RANKS]: computes the field of scripts/demo.sh on several MPI ranks of this machine (default: out/mpi in
# the repository, 2 ranks), makes a picture of it, and compares the eigenvalue with that of one process. Installs and builds
# what it needs.
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

case ${1:-} in
  -h | --help) sed -n '4,6s/^# //p' "${BASH_SOURCE[0]}"; exit 0 ;;
  -*) die "unknown option $1; demo_mpi.sh takes a folder and a number of ranks." ;;
esac
out=${1:-$root/out/mpi}
ranks=${2:-2}
preset=${ALCAP_PRESET:-release}

install_with glmark2-data "${build_packages[@]}" || true
try_install libpetsc-complex3.18-dev libslepc-complex3.18-dev openmpi-bin || die "PETSc, SLEPc and Open MPI are needed: $why"
mesh=/usr/share/glmark2/models/bunny.obj
if [ ! -r "$mesh" ]; then
  say "The bunny is not available: ${why:-there is no $mesh}"
  mesh=$root/build/bumpy_ball.obj
  echo "   Using a generated closed mesh of about as many triangles instead: $mesh"
  mkdir -p "$root/build"
  "$root/scripts/make_mesh.sh" 93 >"$mesh"
fi
(cd "$root" && cmake --preset "$preset" -DALCAP_WITH_PETSC=ON >/dev/null) || die "CMake could not configure."
build "$preset" alcap_cli alcap_mpi
alcap=$root/build/$preset/apps/alcap/alcap
alcap_mpi=$root/build/$preset/apps/alcap_mpi/alcap-mpi

# Open MPI asks before it starts as root and on fewer cores than ranks; other MPIs do not look at this.
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
export OMPI_MCA_mpi_yield_when_idle=1 OMPI_MCA_hwloc_base_binding_policy=none OPENBLAS_NUM_THREADS=1

mkdir -p "$out"
say "Writing the mesh as binary PLY, in which every rank can jump to its slice"
"$alcap" field "$mesh" -n 4 -o "$out/one.ply" --json >"$out/one.json" || die "alcap could not compute the field."
say "Computing the smoothest cross field (n = 4) on $ranks ranks"
mpirun -n "$ranks" "$alcap_mpi" field "$out/one.ply" -n 4 -o "$out" || die "alcap-mpi failed; its message is above."
echo "   one process finds eigenvalue $(grep -m1 -o '"lambda": [0-9.e-]*' "$out/one.json")," \
  "$ranks ranks $(grep -m1 -o '"lambda": [0-9.e-]*' "$out/report.json")"
for name in one field; do
  "$alcap" view "$out/$name.ply" --png "$out/$name.png" -q || echo "   no picture, as the message above says"
done
say "Everything is in $(cd "$out" && pwd); field.png is of $ranks ranks, one.png of one process"
