#!/usr/bin/env bash
# Builds the documents as a site in build/site, gallery with its reports included: bash docs/make_site.sh [--update], see
# docs/site_source.py. Fails for a link that leads nowhere. tests/run.sh calls this.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

venv=build/docs-venv
if ! "$venv/bin/python" -c '' 2>/dev/null; then # not there, or of a Python that is gone
  rm -rf "$venv"
  "${PYTHON:-python3}" -m venv "$venv" || { rm -rf "$venv"; echo "docs/make_site.sh: no venv: run apps/install_deps.sh" >&2; exit 1; }
fi
"$venv/bin/pip" install --quiet --disable-pip-version-check -r docs/requirements.txt
"$venv/bin/python" docs/site_source.py "$@"
# Not --quiet: what is not logged does not count as a warning.
NO_MKDOCS_2_WARNING=1 "$venv/bin/mkdocs" build --strict --config-file docs/mkdocs.yml
echo "docs/make_site.sh: build/site/index.html"
