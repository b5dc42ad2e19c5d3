#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
# arm64.sh [--targets "T..."] [ctest options]: builds the library and its tests for 64-bit ARM with Debian's cross compiler
# and runs the tests under qemu (by default quick and medium). --targets builds only these programs. Compares eigenvalues
# with those of this machine's build (preset ALCAP_PRESET, default release) to 1e-12. Libraries are unpacked into
# build/arm64-libraries; on the system, only the compiler and qemu are installed.
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

if [ "${1:-}" = -h ] || [ "${1:-}" = --help ]; then
  sed -n '4,7s/^# //p' "${BASH_SOURCE[0]}"
  exit 0
fi
targets=(all)
if [ "${1:-}" = --targets ]; then
  [ $# -ge 2 ] || die "--targets needs names"
  read -ra targets <<<"$2"
  shift 2
fi
[ $# -gt 0 ] || set -- -L "quick|medium"
install_packages "${build_packages[@]}" ccache g++-12-aarch64-linux-gnu qemu-user
libraries=$root/build/arm64-libraries
if ! [ -e "$libraries/complete" ]; then
  say "Fetching the libraries for arm64"
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
  mkdir -p "$work/lists/partial" "$work/cache/archives/partial" "$libraries"
  : >"$work/status"
  # An apt of its own that knows arm64 alone and believes that nothing is installed.
  foreign=(apt-get -q -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o "Dir::State::Lists=$work/lists"
    -o "Dir::State::status=$work/status" -o "Dir::Cache=$work/cache" -o Debug::NoLocking=true -o APT::Sandbox::User=)
  "${foreign[@]}" update >"$log" 2>&1 || die "the list of packages for arm64 could not be fetched; see $log"
  "${foreign[@]}" install -y --no-install-recommends --download-only libtbb-dev libsuitesparse-dev libopenblas-dev \
    libstdc++-12-dev libeigen3-dev libspectra-dev libfast-float-dev nlohmann-json3-dev doctest-dev >>"$log" 2>&1 ||
    die "the libraries for arm64 could not be fetched; see $log"
  for package in "$work"/cache/archives/*.deb; do dpkg -x "$package" "$libraries"; done
  touch "$libraries/complete"
fi
build arm64 "${targets[@]}" eigenvalues
build "${ALCAP_PRESET:-release}" eigenvalues
say "Eigenvalues"
blas=$libraries/usr/lib/aarch64-linux-gnu
here=$(mktemp)
there=$(mktemp)
"$root/build/${ALCAP_PRESET:-release}/tests/eigenvalues" >"$here"
qemu-aarch64 -L "$libraries" -E LD_LIBRARY_PATH="$blas/openblas-pthread:$blas/blas:$blas/lapack" \
  "$root/build/arm64/tests/eigenvalues" >"$there"
paste -d ' ' "$here" "$there" | awk '$1 != $5 || $2 != $6 || $3 != $7 { exit 1 }
  { d = $4 - $8; if (d < 0) d = -d; d /= ($4 > 1 ? $4 : 1); if (d > most) most = d }
  END { printf "   %d eigenvalues, the largest difference is %.1e\n", NR, most; exit !(NR > 0 && most <= 1e-12) }' ||
  die "eigenvalues differ by more than 1e-12" "here: $here, there: $there"
rm "$here" "$there"
say "Running the tests under qemu"
cd "$root/build/arm64"
ctest --output-on-failure --no-tests=error -j "$(nproc)" "$@" || die "some tests failed; their output is above."
