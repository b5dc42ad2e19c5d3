#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
# tidy.sh [--all]: runs clang-tidy on the sources that changed since the branch left main (on main: since the previous
# commit), committed or not. A changed header is checked through the sources that include it. --all, or without history:
# every source. ALCAP_BASE=REVISION: compare with this revision instead.
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
cd "$root"
case ${1:-} in
  "" | --all) ;;
  -h | --help) sed -n '4,6s/^# //p' "${BASH_SOURCE[0]}"; exit 0 ;;
  *) die "unknown option $1; tidy.sh takes --all or nothing." ;;
esac

# Only the code that is shipped, and compiled here: src/base/portable/ is what a portable build uses instead.
sources() { git ls-files -- 'src/*.cpp' 'solvers/*.cpp' 'apps/*.cpp' ':!src/base/portable/*'; }

# The commit to compare with; fails where there is none.
base() {
  local main
  if [ -n "${ALCAP_BASE:-}" ]; then
    git rev-parse --verify -q "$ALCAP_BASE^{commit}"
    return
  fi
  for main in origin/main origin/master main master; do
    if git rev-parse --verify -q "$main^{commit}" >/dev/null; then
      main=$(git merge-base HEAD "$main") || return 1
      [ "$main" != "$(git rev-parse HEAD)" ] || main=HEAD~1
      git rev-parse --verify -q "$main^{commit}"
      return
    fi
  done
  git rev-parse --verify -q "HEAD~1^{commit}"
}

# Of the sources: those that changed, and those that include a header that did. All if the rules changed.
changed() {
  local files file name
  files=$(git diff --name-only --diff-filter=d "$1" && git ls-files --others --exclude-standard)
  if grep -qx '\.clang-tidy' <<<"$files"; then
    sources
    return
  fi
  while read -r file; do
    case $file in
      tests/* | perf/* | examples/*) ;;
      *.cpp) echo "$file" ;;
      *.h)
        name=${file#include/}
        git grep -lF "\"$name\"" -- 'src/*.cpp' 'solvers/*.cpp' 'apps/*.cpp' || true
        ;;
    esac
  done <<<"$files" | sort -u | comm -12 - <(sources | sort)
}

what="everything"
if [ -z "${1:-}" ] && since=$(base); then
  list=$(changed "$since")
  what="what changed since $(git rev-parse --short "$since")"
else
  list=$(sources)
fi
if [ -z "$list" ]; then
  echo "   clang-tidy: no source changed"
  exit 0
fi

# Every file has a command of its own only without unity builds. Nothing is compiled there.
if ! cmake --preset dev -B build/tidy -DALCAP_BUILD_TESTS=OFF -DALCAP_WITH_PETSC=AUTO >"$log" 2>&1; then
  cat "$log" >&2
  die "CMake could not configure; its messages are above."
fi
grep -q solvers/petsc build/tidy/compile_commands.json ||
  list=$(grep -Ev "^(solvers/petsc|src/distributed|apps/alcap_mpi)/" <<<"$list" || true)
[ -n "$list" ] || exit 0
echo "   clang-tidy on $what: $(wc -l <<<"$list") files"
tr '\n' '\0' <<<"$list" |
  xargs -0 -n 1 -P "$(jobs)" clang-tidy-14 --quiet --extra-arg=-Wno-unknown-warning-option -p build/tidy 2>&1 |
  sed '/warnings* generated/d'
