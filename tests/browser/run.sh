#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
# run.sh ALCAP WORK [arguments of node --test]: the browser tests with the program ALCAP, packages and files in WORK.
# run.sh ALCAP WORK --times: no tests; how long the studio lets a hand wait (studio_times.mjs).
# Exit code 77, and a line that says why, where something they need is missing; with ALCAP_BROWSER=required, 1.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
alcap=$1 work=$2
shift 2

skip() {
  if [ "${ALCAP_BROWSER:-}" = required ]; then
    printf '\n*** FAILED: %s. The browser tests are required here and did not run. ***\n\n' "$1"
    exit 1
  fi
  printf '\n*** SKIPPED: %s. The browser tests did not run. ***\n\n' "$1"
  exit 77
}
command -v npm >/dev/null && command -v node >/dev/null || skip "npm was not found (Debian: apt-get install npm)"
[ "$(node -p 'parseInt(process.versions.node)')" -ge 18 ] || skip "node is older than 18, which playwright-core needs"
chromium=$(command -v chromium || command -v chromium-browser || true)
[ -n "$chromium" ] || skip "Chromium was not found (Debian: apt-get install chromium)"
mkdir -p "$work"
if ! cmp -s "$here/package-lock.json" "$work/installed"; then
  cp "$here/package.json" "$here/package-lock.json" "$work"
  (cd "$work" && npm ci --ignore-scripts --no-audit --no-fund --prefer-offline --fetch-retries=1 --loglevel=error) ||
    skip "npm could not install playwright-core"
  cp "$here/package-lock.json" "$work/installed"
fi
"$alcap" make icosphere:1 -o "$work/probe.ply" -q
if ! said=$("$alcap" field "$work/probe.ply" --html "$work/probe.html" -q 2>&1); then
  case $said in *"built without its page"*) skip "$said" ;; esac
  printf '%s\n' "$said"
  exit 1
fi
# node looks for packages beside the script.
cp "$here"/*.mjs "$work"
cd "$work"
export ALCAP=$alcap CHROMIUM=$chromium
[ "${1:-}" != --times ] || exec node studio_times.mjs
exec node --test --test-concurrency=2 "$@" studio.test.mjs design.test.mjs controls.test.mjs features.test.mjs merging.test.mjs steady.test.mjs hands.test.mjs access.test.mjs story.test.mjs view.test.mjs
