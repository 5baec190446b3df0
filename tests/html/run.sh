#!/usr/bin/env bash
# Opens reports of every command in headless Chromium (apt's) and drives them: bash tests/html/run.sh [arguments of pytest].
# They are written by the program MJCF_PDG_CLI, default build/bin/mjcf-pdg; the browser is MJCF_PDG_CHROMIUM, if that is set.
# Screenshots go to build/html-screenshots. tests/run.sh calls this.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

python=${PYTHON:-python3}
venv=build/html-venv
export MJCF_PDG_CLI=${MJCF_PDG_CLI:-$PWD/build/bin/mjcf-pdg}
export MJCF_PDG_SCREENSHOTS=$PWD/build/html-screenshots

if [ -z "${MJCF_PDG_CHROMIUM:-}" ]; then
  MJCF_PDG_CHROMIUM=$(command -v chromium-headless-shell || command -v chromium) || {
    echo "tests/html/run.sh: SKIPPED, there is no headless Chromium (Debian: chromium-headless-shell, or set MJCF_PDG_CHROMIUM)" >&2
    exit 0
  }
  export MJCF_PDG_CHROMIUM
fi
if ! "$python" -c 'import sys; sys.exit(sys.version_info < (3, 10))'; then
  echo "tests/html/run.sh: SKIPPED, its packages need Python 3.10 and this is $("$python" --version)" >&2
  exit 0
fi
. python/venv.sh
make_venv "$venv"
"$venv/bin/pip" install --quiet --disable-pip-version-check -r tests/html/requirements.txt
exec "$venv/bin/python" -m pytest -q -p no:cacheprovider tests/html "$@"
