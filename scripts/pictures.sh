#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
# pictures.sh [PROGRAM]: makes the pictures of the pages in docs/ anew: those of the command line, and those of the studio,
# which its browser tests take. PROGRAM is the alcap to use; by default it is built (preset release).
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

case ${1:-} in
  -h | --help) sed -n '4,5s/^# //p' "${BASH_SOURCE[0]}"; exit 0 ;;
  -*) die "unknown option $1; pictures.sh takes one program." ;;
esac
[ $# -le 1 ] || die "pictures.sh takes one program, not $#."
if [ $# -eq 1 ]; then
  alcap=$(realpath "$1")
else
  install_packages glmark2-data npm chromium "${build_packages[@]}"
  build release alcap_cli
  alcap=$root/build/release/apps/alcap/alcap
fi
work=$root/build/pictures
mkdir -p "$work"

say "Pictures of the command line"
"$alcap" field /usr/share/glmark2/models/bunny.obj -n 4 --png "$root/docs/bunny.png" --png-size 880,660 -q
"$alcap" make icosphere:5 -o "$work/ball.ply" -q
picture() {  # DESIGN NAME WIDTH,HEIGHT AZ,EL
  "$alcap" design "$work/ball.ply" --design "$root/datasets/designs/$1.json" -o "$work/$1" -q \
    --png "$root/docs/images/$2.png" --png-size "$3" --view "$4" --curve-spacing 0.025
}
picture fig6_saddle saddle 360,360 7,17
picture fig6_saddle_turned saddle_turned 360,360 7,17
picture cones_icosphere cones 420,420 30,20

say "Pictures of the studio"
STORY=$root/docs/images "$root/tests/browser/run.sh" "$alcap" "$work/browser" --test-name-pattern='place a source|features: the field'
