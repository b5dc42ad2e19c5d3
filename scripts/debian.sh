#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
#
# debian.sh [--keep]: builds the Debian packages in build/debian from a clean checkout of the last commit. Checks them with
# lintian, unpacks them into a separate tree, and tests them there: the tool, a C++ program, a C program, the binary
# interface of the C library against its record, and Python.
# --keep: continue in the existing tree without cleaning it. Takes about ten minutes on two idle cores.
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

keep=
case ${1:-} in
  --keep) keep=yes ;;
  '') ;;
  *) sed -n '4,7s/^# //p' "${BASH_SOURCE[0]}"; exit 2 ;;
esac
install_packages "${build_packages[@]}" "${python_packages[@]}" debhelper dh-python dpkg-dev fakeroot lintian pkg-config
version=$(sed -n 's/^project(alcap VERSION \([0-9.]*\).*/\1/p' "$root/CMakeLists.txt")
grep -q "^alcap ($version-" "$root/debian/changelog" || die "debian/changelog does not begin with version $version"

work=$root/build/debian tree=$root/build/debian/alcap-$version
if [ -z "$keep" ] || [ ! -d "$tree" ]; then
  rm -rf "$work"
  mkdir -p "$work"
  git -C "$root" archive --prefix="alcap-$version/" HEAD | tar -x -C "$work"
  tar -C "$work" --exclude=debian -czf "$work/alcap_$version.orig.tar.gz" "alcap-$version"
fi
say "Building the packages in $tree"
# The build has a home of its own; the compiler's cache is that of whoever calls.
if command -v ccache >/dev/null; then
  CCACHE_DIR=${CCACHE_DIR:-$(ccache -k cache_dir 2>/dev/null || true)}
  [ -z "$CCACHE_DIR" ] || export CCACHE_DIR
fi
# -d: what is needed may lie elsewhere than in packages. No network: npm is not asked.
(cd "$tree" && DEB_BUILD_OPTIONS="parallel=$(jobs) noautodbgsym ${DEB_BUILD_OPTIONS:-}" dpkg-buildpackage -us -uc -d ${keep:+-nc}) \
  >"$work/build.log" 2>&1 || { tail -n 30 "$work/build.log" >&2; die "the packages could not be built; see $work/build.log"; }

say "lintian"
lintian --allow-root --fail-on error,warning "$work"/alcap_"$version"-*_*.changes || die "lintian complains, see above"

say "Trying the packages, unpacked"
inside=$work/root
rm -rf "$inside"
for package in "$work"/*.deb; do dpkg-deb -x "$package" "$inside"; done
libraries=$(dirname "$(find "$inside/usr/lib" -name 'libalcap.so')")
export LD_LIBRARY_PATH=$libraries
cd "$work"
"$inside/usr/bin/alcap" make icosphere:3 -o ball.ply -q
"$inside/usr/bin/alcap" field ball.ply -n 4 --json >field.json
grep -q '"ok": true' field.json || die "the tool computed no field"
PYTHONPATH=$inside/usr/lib/python3/dist-packages /usr/bin/python3 - <<'PYTHON'
import importlib.metadata

import alcap
run = alcap.smoothest_field(alcap.Surface(*alcap.shapes.icosphere(3)), n=4)
assert run.holds and run.indices.sum() == 8
assert importlib.metadata.version('alcap') == alcap.__version__
print('Python:', run)
PYTHON
# pkg-config's files are relative to themselves, so the unpacked tree needs no installation.
export PKG_CONFIG_PATH=$libraries/pkgconfig
awk '/^```c$/ { inside = 1; next } /^```$/ { if (inside) exit } inside' "$root/docs/c.md" >program.c
cc -std=c99 -pedantic program.c -o program_c $(pkg-config --cflags --libs alcap_c)
./program_c
/usr/bin/python3 -B "$root/tests/c/abi.py" --cc cc --library "$libraries/libalcap_c.so" --nm nm --include "$inside/usr/include" \
  --record "$root/tests/c/abi.txt"
c++ -std=c++20 "$root/tests/build/consumer.cpp" -o program_cpp $(pkg-config --cflags --libs alcap)
./program_cpp
say "Packages, in $work:"
(cd "$work" && ls -1 ./*.deb)
