#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
# demo.sh [FOLDER]: computes the smoothest cross field on the Stanford bunny from Debian's glmark2-data, an unprocessed scan
# of 70,000 triangles. Writes the field, its certificate, a picture and a page for the browser to FOLDER (default:
# out/bunny in the repository). Installs and builds what it needs.
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
  say "The bunny is not available: ${why:-there is no $mesh}"
  mesh=$root/build/bumpy_ball.obj
  echo "   Using a generated closed mesh of about as many triangles instead: $mesh"
  mkdir -p "$root/build"
  "$root/scripts/make_mesh.sh" 93 >"$mesh"
fi
# npm fetches what the page to turn in the browser is made of; all else works without.
command -v npm >/dev/null || try_install npm || echo "   npm is not available, so there will be no page: $why"
build "$preset" alcap_cli

say "Computing the smoothest cross field (n = 4) on $mesh"
alcap=$root/build/$preset/apps/alcap/alcap
# The picture needs OpenGL and the page npm; where one cannot be had (exit code 6 or 2), the rest is made without it.
rm -f "$out/field.png" "$out/field.html"
for extras in "png html" html png ""; do
  code=0
  options=()
  for kind in $extras; do options+=("--$kind" "$out/field.$kind"); done
  "$alcap" field "$mesh" -n 4 -o "$out" "${options[@]}" || code=$?
  case $code in
    2 | 6) say "Some outputs cannot be made on this machine, see the message above; continuing without them" ;;
    *) break ;;
  esac
done
[ "$code" -eq 0 ] || die "alcap exited with code $code; its message is above."
say "Everything is in $(cd "$out" && pwd); the certificate is report.json, field.vtp opens in ParaView"
[ ! -e "$out/field.png" ] || echo "   Look at $out/field.png"
[ ! -e "$out/field.html" ] || echo "   Open $out/field.html in a browser"
