#!/usr/bin/env bash
# Makes bundle.js, which the program puts into each report, from report.js and three.js. The bundle is checked in, so that nobody
# needs npm to build mjcf-pdg; whoever changes a script here runs this and commits both. Its first line is the hash of what it
# was made from, which tests/html/test_reports.py compares.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
npm install --no-save --no-package-lock --no-audit --no-fund >&2
sources=$(cat package.json bodies.js dom.js packed.js plots.js report.js rows.js stage.js | sha256sum | cut -d ' ' -f 1)
npx esbuild report.js --bundle --minify --format=iife --charset=ascii --legal-comments=inline \
  --banner:js="// sources: $sources" --outfile=bundle.js
rm -r node_modules
