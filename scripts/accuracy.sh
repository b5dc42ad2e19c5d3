#!/bin/sh
# SPDX-License-Identifier: MIT
#
# Repeats all measurements of docs/accuracy.md and writes the page: scripts/accuracy.sh [PATH TO alcap]
# Takes a minute. Except for the last digits, the numbers do not depend on the machine.
set -eu
cd "$(dirname "$0")/.."
alcap=${1:-build/release/apps/alcap/alcap}
if [ ! -x "$alcap" ]; then
  echo "scripts/accuracy.sh: $alcap is not an executable; build it, or pass the path to alcap" >&2
  exit 2
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$alcap" make genus:2,6 -o "$folder/holes.ply" --quiet
"$alcap" tables --more --levels 2,3,4 --mesh "$folder/holes.ply" --json > "$folder/tables.json"
python3 scripts/accuracy.py "$alcap" "$folder" > "$folder/accuracy.md"
cp "$folder/accuracy.md" docs/accuracy.md
