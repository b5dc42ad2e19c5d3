#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
# compare_fields.sh OLD NEW [MESH...]: checks whether two builds of alcap write bitwise identical fields, for ten generated
# meshes (and the given ones) at n = 1, 2, 4, 6. Prints the differences; exits with 1 if there are any.
set -euo pipefail
case ${1:-} in
  "" | -h | --help) sed -n '4,5s/^# //p' "${BASH_SOURCE[0]}"; exit 0 ;;
esac
old=$1 new=$2
shift 2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

meshes=()
for kind in tetrahedron cube icosphere:4 bumpy:4,0.3,4 scan:4,0.3 torus:60,30,1,0.4 genus:3,20 disk:20 grid:30,20,3,2 \
  cylinder:40,20,1,3; do
  mesh=$work/$(tr ':,.' '___' <<<"$kind").ply
  "$old" make "$kind" -o "$mesh" -q
  meshes+=("$mesh")
done

# field PROGRAM MESH N FOLDER: the field's file, or its exit code and complaint where there is none.
field() {
  local code=0
  "$1" field "$2" -n "$3" --formats ply -o "$4/" -q >/dev/null 2>&1 || code=$?
  [ -e "$4/field.ply" ] || { mkdir -p "$4"; echo "exit code $code" >"$4/field.ply"; }
}

compared=0 differ=0
for mesh in "${meshes[@]}" "$@"; do
  for n in 1 2 4 6; do
    rm -rf "$work/old" "$work/new"
    field "$old" "$mesh" "$n" "$work/old"
    field "$new" "$mesh" "$n" "$work/new"
    compared=$((compared + 1))
    cmp -s "$work/old/field.ply" "$work/new/field.ply" || {
      differ=$((differ + 1))
      echo "differs: $(basename "$mesh"), n = $n"
    }
  done
done
echo "$compared fields compared, $differ differ"
[ "$differ" = 0 ]
