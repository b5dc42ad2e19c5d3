#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
# docs.sh [--check] [FOLDER]: builds the site (pages and API reference) in FOLDER (default: build/docs) with Doxygen and
# Python. Needs no network. --check: fails on any Doxygen warning, including undocumented public names, and on any problem
# that docs_check.py finds: dead links and anchors, files and tests that do not exist, programs that differ from their
# page.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
check=
if [ "${1:-}" = --check ]; then
  check=yes
  shift
fi
case ${1:-} in
  -*) sed -n '4,7s/^# //p' "${BASH_SOURCE[0]}"; exit 2 ;;
esac
out=${1:-build/docs}
command -v doxygen >/dev/null || { echo "docs.sh: doxygen is missing: apt-get install doxygen" >&2; exit 3; }
mkdir -p "$out"
version=$(sed -n 's/^project(alcap VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
{
  cat docs/site/Doxyfile
  printf 'OUTPUT_DIRECTORY = "%s"\nPROJECT_NUMBER = "%s"\nWARN_LOGFILE = "%s/warnings.txt"\n' "$out" "$version" "$out"
} >"$out/Doxyfile"
doxygen "$out/Doxyfile"
failed=
if [ -s "$out/warnings.txt" ]; then
  cat "$out/warnings.txt" >&2
  [ -z "$check" ] || { echo "docs.sh: Doxygen warned, see above" >&2; failed=yes; }
fi
if [ -n "$check" ]; then
  python3 -B scripts/docs_check.py || failed=yes
fi
[ -z "$failed" ] || exit 1
echo "The site is in $out/html: open $out/html/index.html"
