#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
# demo.sh [FOLDER]: computes a smoothest cross field on the Stanford bunny, as it comes from the scanner (69,451
# triangles, holes and dirt included), and writes the field and its certificate into FOLDER (default out/bunny).
# Installs and builds what it needs.
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

case ${1:-} in
  -h | --help) sed -n '4,6s/^# //p' "${BASH_SOURCE[0]}"; exit 0 ;;
  -*) die "unknown option $1; demo.sh takes one folder." ;;
esac
[ $# -le 1 ] || die "demo.sh takes one folder, not $#."
out=${1:-$root/out/bunny}
preset=${ALCAP_PRESET:-release}

install_with glmark2-data "${build_packages[@]}" || true
mesh=/usr/share/glmark2/models/bunny.obj
if [ ! -r "$mesh" ]; then
  say "The bunny cannot be had: ${why:-there is no $mesh}"
  mesh=$root/build/bumpy_ball.obj
  echo "   Using a generated closed mesh of about as many triangles instead: $mesh"
  mkdir -p "$root/build"
  "$root/scripts/make_mesh.sh" 93 >"$mesh"
fi
build "$preset" alcap_cli

say "Computing the smoothest cross field (n = 4) on $mesh"
alcap=$root/build/$preset/apps/alcap/alcap
"$alcap" field "$mesh" -n 4 -o "$out" --report "$out/report.json" ||
  die "alcap exited with code $?; its message is above."

say "Written to $(cd "$out" && pwd)"
ls -lh "$out" | awk 'NR > 1 { printf "   %-24s %s\n", $9, $5 }'
