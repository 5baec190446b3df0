#!/usr/bin/env bash
# Installs what is missing, builds with all cores, runs every test: bash tests/run.sh [release|ci|shared|debug|sanitize|tsan]
# Default: release, in build/. Where CI is set: ci, which is the same with warnings as errors.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=${1:-release}
if [ $# -eq 0 ] && [ -n "${CI:-}" ]; then
  preset=ci
fi

bash apps/install_deps.sh
cmake --preset "$preset" -D MJCF_PDG_BUILD_TESTS=ON
cmake --build --preset "$preset" --parallel "$(nproc)"
ctest --preset "$preset" --parallel "$(nproc)" --no-tests=error </dev/null
case "$preset" in
  release | ci) # of build/bin/mjcf-pdg; the browser's tests wait a lot, so that the others run meanwhile
    bash tests/html/run.sh </dev/null >build/html-tests.log 2>&1 &
    html=$!
    trap 'kill $html 2>/dev/null || true' EXIT
    bash python/run_tests.sh </dev/null
    bash docs/make_site.sh </dev/null
    wait $html || {
      cat build/html-tests.log
      exit 1
    }
    cat build/html-tests.log
    trap - EXIT
    ;;
esac
