#!/bin/sh
# SPDX-License-Identifier: MIT
#
# Fields to an angle of 0.01 degrees, over connections to 1e-6, against the same fields at 1e-10, on random meshes: the angle between the two beside
# the one that was reported, and the singularities. Fails where the angle is beyond its bound, or singularities moved
# further than into a neighbouring face although the second eigenvalue is not close and the vector not below 1e-4 there.
#
#   scripts/hunt_accuracy.sh [RUNS] [SEED] [FAMILY]     100 runs; the seed is the time of day
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
build=${ALCAP_BUILD:-$root/build/release}
[ -f "$build/CMakeCache.txt" ] || cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release
cmake --build "$build" --target hunt_accuracy
seed=${2:-$(date +%s)}
echo "seed $seed"
exec "$build/tests/hunt_accuracy" "${1:-100}" "$seed" ${3:+"$3"}
