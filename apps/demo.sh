#!/usr/bin/env bash
# Installs what is missing, builds, and repairs the three demo models: tables here, files in build/demo/.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

models=(models/puma/puma_car.xml models/hand/hand_bottle.xml models/figure/figure_bench.xml)
program=build/bin/mjcf-pdg
out=build/demo

bash apps/install_deps.sh
cmake --preset release
cmake --build --preset release --parallel "$(nproc)" --target mjcf-pdg
mkdir -p "$out"

pictures=yes
if ! grep -q -e --png <<<"$("$program" solve --help)"; then
  pictures=no
  echo "This build has no rendering (EGL, libpng or giflib not found): no pictures."
fi

failed=()
for model in "${models[@]}"; do
  name=$(basename "$model" .xml)
  arguments=(solve "$model" --json "$out/$name.jsonl" --out-mjcf "$out/${name}_repaired.xml")
  if [ $pictures = yes ]; then
    arguments+=(--png "$out/$name.png")
  fi
  printf '\n$ %s\n' "$program ${arguments[*]}"
  "$program" "${arguments[@]}" || failed+=("$model (exit $?)")
done

printf '\nResults (.jsonl), repaired models (.xml) and pictures (.png) are in %s:\n' "$PWD/$out"
ls "$out"
if [ ${#failed[@]} -gt 0 ]; then
  printf 'Failed: %s\n' "${failed[@]}" >&2
  exit 1
fi
