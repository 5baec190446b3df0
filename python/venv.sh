# To be sourced: make_venv DIR makes a virtual environment of PYTHON (default python3), unless it is there.
make_venv() {
  "$1/bin/python" -c '' 2>/dev/null && return # not so if the Python that it was made of is gone
  rm -rf "$1"
  "${PYTHON:-python3}" -m venv "$1" || {
    rm -rf "$1"
    echo "$0: no virtual environment: run apps/install_deps.sh" >&2
    exit 1
  }
}
