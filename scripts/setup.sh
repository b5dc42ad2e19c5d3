# SPDX-License-Identifier: MIT
#
# setup.sh: functions shared by demo.sh, test.sh and CI; sourced, not run. Installs missing Debian packages, configures,
# and builds. Initially needs only bash.
#
#   . "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
#   install_packages "${build_packages[@]}"
#   build release [targets...]
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
log=${TMPDIR:-/tmp}/alcap-setup-$(id -u).log

build_packages=(g++ cmake ninja-build libeigen3-dev libtbb-dev libsuitesparse-dev libopenblas-dev libspectra-dev
  libfast-float-dev libcli11-dev nlohmann-json3-dev libfmt-dev libcpp-httplib-dev doctest-dev libpng-dev
  libegl-dev libgles-dev libgl1-mesa-dri)
# Of the Python package and its tests.
python_packages=(python3-dev pybind11-dev python3-pybind11 python3-numpy python3-scipy python3-matplotlib python3-pip
  python3-venv python3-pytest mypy)
# Without them the notebooks run in the tests as plain Python.
notebook_packages=(jupyter-nbconvert python3-ipykernel)

say() { printf '\n== %s\n' "$*"; }
die() {
  printf '\nStopped: %s\n' "$1" >&2
  shift
  [ $# -eq 0 ] || printf '  %s\n' "$@" >&2
  exit 1
}

# missing_packages names...: those that dpkg does not have installed, one a line.
missing_packages() {
  local name
  for name in "$@"; do
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$name" 2>/dev/null)" = installed ] || printf '%s\n' "$name"
  done
}

# as_root command...: runs it as root if there is a way that asks nobody anything, or a person to ask.
as_root() {
  if [ "$(id -u)" = 0 ]; then
    "$@"
  else
    sudo "$@"
  fi
}
can_be_root() {
  [ "$(id -u)" = 0 ] || { command -v sudo >/dev/null && { sudo -n true 2>/dev/null || [ -t 0 ]; }; }
}

# try_install names...: installs those that are missing; returns 1, with the reason in $why, where it cannot.
why=
try_install() {
  local missing
  why=
  if ! command -v dpkg-query >/dev/null; then
    echo "   This is not Debian, so nothing is installed. Required are the contents of these Debian packages: $*"
    return 0
  fi
  mapfile -t missing < <(missing_packages "$@")
  [ ${#missing[@]} -gt 0 ] || return 0
  if ! can_be_root; then
    why="packages are missing, and there is no way from here to install them (not root, no sudo without a password).
  Run this as root, then start again:
  apt-get update && apt-get install -y --no-install-recommends ${missing[*]}"
    return 1
  fi
  say "Installing ${#missing[@]} Debian packages: ${missing[*]}"
  echo "   fetching the list of packages (details in $log)"
  if ! as_root env DEBIAN_FRONTEND=noninteractive apt-get update -q -o DPkg::Lock::Timeout=300 </dev/null >"$log" 2>&1; then
    echo "   the list of packages could not be fetched completely; trying with what is there"
  fi
  echo "   downloading and unpacking; on a bare machine this takes a few minutes"
  if ! as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends \
    -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0 "${missing[@]}" </dev/null >>"$log" 2>&1; then
    why="apt-get could not install ${missing[*]}. The end of $log:
$(tail -n 8 "$log" | sed 's/^/    /')"
    return 1
  fi
  echo "   done"
}

# install_packages names...: installs what is missing or stops.
install_packages() { try_install "$@" || die "$why"; }

# install_with OPTIONAL names...: as install_packages, but only says so (returning 1) where just OPTIONAL cannot be had.
install_with() {
  local optional=$1 reason
  shift
  try_install "$optional" "$@" && return 0
  reason=$why
  [ -z "$(missing_packages "$@")" ] || ! can_be_root || try_install "$@" || reason=$why
  [ -z "$(missing_packages "$@")" ] || die "$reason"
  why=$reason
  return 1
}

# How many compilers at once: one per core, with 1.5 GB for each (templates are hungry), at least one.
jobs() {
  local cores memory limit
  cores=$(nproc)
  memory=$(awk '$1 == "MemAvailable:" { print int($2 / 1024) }' /proc/meminfo 2>/dev/null || true)
  limit=$(cat /sys/fs/cgroup/memory.max 2>/dev/null || true)
  [[ $limit =~ ^[0-9]+$ ]] && limit=$((limit / 1048576)) && [ "$limit" -lt "${memory:-$limit}" ] && memory=$limit
  [ -n "$memory" ] && [ $((memory / 1500)) -lt "$cores" ] && cores=$((memory / 1500))
  [ "$cores" -ge 1 ] || cores=1
  echo "$cores"
}

# build preset [targets...]: configures and builds in build/PRESET; everything if no target is named.
build() {
  local preset=$1 target=() started=$SECONDS
  local folder=$root/build/$preset
  shift
  [ $# -eq 0 ] || target=(--target "$@")
  # Once configured, the build itself sees what changed; only the presets it does not know.
  if ! [ "$folder/build.ninja" -nt "$root/CMakePresets.json" ]; then
    say "Configuring (preset $preset, in $folder)"
    if ! (cd "$root" && cmake --preset "$preset" >"$log" 2>&1); then
      cat "$log" >&2
      die "CMake could not configure; its messages are above." "If build/$preset is from another machine, delete it."
    fi
  fi
  say "Building with $(jobs) parallel jobs"
  cmake --build "$folder" -j "$(jobs)" ${target[@]+"${target[@]}"} ||
    die "the build failed; the compiler's message is above."
  echo "   built in $((SECONDS - started)) s"
}
