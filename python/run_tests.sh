#!/usr/bin/env bash
# Builds the Python package, installs it into an environment of its own (build/python-venv) and runs its tests there:
# bash python/run_tests.sh [arguments of pytest]. Answers are held against those of the program MJCF_PDG_CLI, default
# build/bin/mjcf-pdg. tests/run.sh calls this.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

python=${PYTHON:-python3}
venv=build/python-venv
export MJCF_PDG_CLI=${MJCF_PDG_CLI:-$PWD/build/bin/mjcf-pdg}

if ! "$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))'; then
  echo "python/run_tests.sh: SKIPPED, MuJoCo 4.0's own package needs Python 3.11 and this is $("$python" --version)" >&2
  exit 0
fi
. python/venv.sh
make_venv "$venv"
if ! "$venv/bin/pip" install --quiet --disable-pip-version-check -r python/requirements-test.txt; then
  echo "python/run_tests.sh: the packages of python/requirements-test.txt could not be installed: this needs the" >&2
  echo "package index, or a folder of wheels in PIP_FIND_LINKS with PIP_NO_INDEX=1" >&2
  exit 1
fi
if [ -n "${CI:-}${MJCF_PDG_PYTHON_EXTRAS:-}" ]; then
  "$venv/bin/pip" install --quiet --disable-pip-version-check -r python/requirements-optional.txt ||
    echo "python/run_tests.sh: not all of requirements-optional.txt, the tests that need them are skipped" >&2
fi
# Without isolation: the build finds what it needs where it was the last time, and compiles only what has changed. The
# library that tests/run.sh has built is not compiled again.
settings=()
if [ -f build/libmjcf_pdg.a ]; then
  settings=("--config-settings=cmake.define.MJCF_PDG_LIBRARY=$PWD/build/libmjcf_pdg.a")
fi
"$venv/bin/pip" install --quiet --disable-pip-version-check --no-build-isolation --no-deps --force-reinstall \
  ${settings[@]+"${settings[@]}"} .
exec "$venv/bin/python" -m pytest -q -p no:cacheprovider "$@"
