#!/usr/bin/env bash
# Installs what building and running mjcf-pdg needs (Debian 12 and 13, Ubuntu 22.04 and 24.04: the packages have the
# same names there; on Ubuntu most are in `universe`, which its images have switched on).
# Quick when all is there. MJCF_PDG_SKIP_DEPS=1 skips the check, for machines that get the packages in another way.
# MuJoCo and Ruckig are not among them: CMake finds or fetches them.
set -euo pipefail

packages=(
  g++ cmake make
  python3 python3-pip                              # to fetch MuJoCo and Ruckig
  python3-venv python3-dev                         # the Python package and its tests
  libfcl-dev                                       # triangle meshes
  libeigen3-dev libassimp-dev zlib1g-dev           # zlib: reports; Debian's assimp needs it to link, too
  libcli11-dev nlohmann-json3-dev libboost-dev     # Boost: progress bars
  libgtest-dev libgmock-dev
  libcgal-dev                                      # tests and benches only: a second opinion on meshes
  libegl-dev libegl1 libegl-mesa0 libgl1-mesa-dri libpng-dev libgif-dev  # pictures without a screen
  libglfw3-dev libimgui-dev                        # the command view
  xvfb xauth xdotool                               # tests and docs only: a window on a display in memory, events for it
  libompl-dev libboost-filesystem-dev libboost-serialization-dev libboost-system-dev  # the command plan
  patchelf                                         # packages only (preset `package`)
  mandoc pkg-config                                # tests only: manual pages, a consumer of what is installed
)
# Where there is none, tests that need it are skipped. Ubuntu has no headless Chromium.
optional=(
  chromium-headless-shell                          # tests only: reports in a browser
)

if [ -n "${MJCF_PDG_SKIP_DEPS:-}" ]; then
  exit 0
fi

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  cat >&2 <<'END'
install_deps: this is not a Debian or Ubuntu system, so please install by hand:
  a C++20 compiler, CMake 3.22 or newer, make, python3 with pip, venv and headers (or set MuJoCo_ROOT to an unpacked MuJoCo 4.0.x);
  with headers: Eigen 3.4, FCL 0.7, assimp 5.2, zlib, CLI11 2.1, nlohmann-json 3.9, Boost 1.74; for tests GoogleTest 1.11 with
  GMock, CGAL 5.4;
  for the command plan: OMPL 1.5 with headers, and those of Boost that it includes;
  for the command view: GLFW 3.3 with headers, Dear ImGui 1.86 as a library with its back ends for GLFW and OpenGL 3, and stb;
  for its tests Xvfb and xdotool;
  for pictures: EGL, libpng and giflib with headers, and Mesa's EGL with its software driver (llvmpipe).
Then run this again with MJCF_PDG_SKIP_DEPS=1.
END
  exit 1
fi

is_installed() {
  grep -qx installed <<<"$(dpkg-query --show --showformat '${db:Status-Status}\n' "$1" 2>/dev/null)"
}
list_missing() { # of the optional ones those that there are
  missing=()
  for package in "${packages[@]}"; do
    is_installed "$package" || missing+=("$package")
  done
  for package in "${optional[@]}"; do
    is_installed "$package" || ! apt-cache show "$package" >/dev/null 2>&1 || missing+=("$package")
  done
}
list_missing
if [ ${#missing[@]} -eq 0 ]; then
  exit 0
fi

# sudo may ask for a password only where somebody can type it.
if [ "$(id -u)" -eq 0 ]; then
  as_root=()
elif command -v sudo >/dev/null && { sudo -n true 2>/dev/null || [ -t 0 ]; }; then
  as_root=(sudo)
else
  {
    echo "install_deps: some packages are missing, and installing them needs root. Please have this run:"
    echo "  apt-get install --no-install-recommends ${missing[*]}"
    echo "If you have them in another way, set MJCF_PDG_SKIP_DEPS=1."
  } >&2
  exit 1
fi

apt() { # the ${...+...} form: bash before 4.4 calls an empty array unset
  ${as_root[@]+"${as_root[@]}"} env DEBIAN_FRONTEND=noninteractive \
    apt-get -q -o DPkg::Lock::Timeout=300 "$@" </dev/null
}
echo "Installing ${missing[*]}"
apt update || echo "install_deps: apt-get update failed, trying with the lists at hand" >&2
list_missing # the optional ones may have become known
apt install -y --no-install-recommends "${missing[@]}"
