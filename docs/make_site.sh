#!/usr/bin/env bash
# Builds the documents as a site in build/site, gallery with its reports included: bash docs/make_site.sh [--update], see
# docs/site_source.py. Fails for a link that leads nowhere. tests/run.sh calls this.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

venv=build/docs-venv
. python/venv.sh
make_venv "$venv"
"$venv/bin/pip" install --quiet --disable-pip-version-check -r docs/requirements.txt
"$venv/bin/python" docs/site_source.py "$@"
# Not --quiet: what is not logged does not count as a warning.
NO_MKDOCS_2_WARNING=1 "$venv/bin/mkdocs" build --strict --config-file docs/mkdocs.yml
echo "docs/make_site.sh: build/site/index.html"
