#!/usr/bin/env bash
# tests/run.sh sanitize, as much of it as fits into so many seconds: bash tests/sanitized.sh SECONDS
# Fails for a test that fails, not for those that were not reached; the last line says how many passed, of how many. .ci/run calls
# this with what is left of its hour: build and tests take 40 to 50 minutes on two cores.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

log=build-sanitize/suite.log
mkdir -p build-sanitize
echo 'int main() {}' >build-sanitize/probe.cc
if ! { c++ -fsanitize=address,undefined build-sanitize/probe.cc -o build-sanitize/probe && build-sanitize/probe; } >"$log" 2>&1; then
  cat "$log"
  echo "tests/sanitized.sh: SKIPPED, not even an empty program runs under sanitizers here (LeakSanitizer needs ptrace)" >&2
  exit 0
fi

status=0
timeout "$1" bash tests/run.sh sanitize >"$log" 2>&1 || status=$?
if [ $status -ne 0 ] && { [ $status -ne 124 ] || grep -qE '\*\*\*(Failed|Exception|Timeout)' "$log"; }; then
  tail -n 300 "$log"
  grep -E '\*\*\*|ERROR: |runtime error' "$log" || true # what failed, again: CI may show only the end of what was printed
  exit 1
fi
all=$(grep -oE '/[0-9]+ Test ' "$log" | tail -n 1 | tr -dc 0-9 || true)
echo "tests/sanitized.sh: $(grep -c ' Passed ' "$log" || true) tests passed of ${all:-none, as the build took too long}"
