#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
# python.sh [--fresh] [--build FOLDER] [--work FOLDER] [pytest options]: builds the wheel of the Python package, installs it
# in a new virtual environment that uses Debian's NumPy and SciPy, checks the types, and runs the tests there.
# --fresh: installs from the source archive of the last commit with a single `pip install`. --build: takes the module from
# this configured build (default: build/python, which is configured if necessary). --work: folder of wheel and environment
# (default: build/python-test). ALCAP_CMAKE_ARGS in the environment: more arguments for CMake. Exits with 77 if pybind11,
# NumPy, SciPy or pytest is missing.
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

folder='' fresh='' work=$root/build/python-test install=yes
while [ $# -gt 0 ]; do
  case $1 in
    --fresh) fresh=yes; shift ;;
    --build) folder=$2 install=; shift 2 ;;
    --work) work=$2; shift 2 ;;
    -h | --help) sed -n '4,9s/^# //p' "${BASH_SOURCE[0]}"; exit 0 ;;
    *) break ;;
  esac
done
[ -z "$install" ] || install_packages "${build_packages[@]}" "${python_packages[@]}"

# Debian's packages belong to Debian's Python, which need not be the first in PATH.
python=/usr/bin/python3
[ -x "$python" ] || python=python3
for module in numpy scipy pytest venv pip; do
  "$python" -c "import $module" 2>/dev/null ||
    { echo "SKIPPED: $python has no $module; on Debian: apt-get install ${python_packages[*]}"; exit 77; }
done

rm -rf "$work"
mkdir -p "$work"
"$python" -m venv --system-site-packages --without-pip "$work/venv"
pip=("$python" -m pip --python "$work/venv/bin/python" install --quiet --no-deps --no-index)
if [ -n "$fresh" ]; then
  git -C "$root" archive --prefix=tree/ HEAD | tar -x -C "$work"
  (cd "$work/tree/python" && "$python" -B -c "import build_backend; build_backend.build_sdist('$work')")
  rm -rf "$work/tree"
  say "pip install $(cd "$work" && echo alcap-*.tar.gz)"
  "${pip[@]}" --no-build-isolation "$work"/alcap-*.tar.gz
else
  "$python" -m pip wheel --quiet --no-deps --no-build-isolation --no-index \
    ${folder:+--config-settings=build-dir="$folder"} -w "$work" "$root"
  "${pip[@]}" "$work"/alcap-*.whl
  ALCAP_WHEEL=$(echo "$work"/alcap-*.whl)
  export ALCAP_WHEEL
fi
cd "$work"  # nothing of the repository in the path
export ALCAP_SOURCE_DIR=$root
exec "$work/venv/bin/python" -m pytest -q -p no:cacheprovider "$root/python/tests" "$@"
