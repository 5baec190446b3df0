#!/usr/bin/env bash
# Makes bundle.js, which the program puts into each report, from report.js and three.js. The bundle is checked in, so that nobody
# needs npm to build mjcf-pdg; whoever changes report.js or stage.js runs this and commits both.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
npm install --no-save --no-package-lock --no-audit --no-fund >&2
npx esbuild report.js --bundle --minify --format=iife --charset=ascii --legal-comments=inline --outfile=bundle.js
rm -r node_modules
