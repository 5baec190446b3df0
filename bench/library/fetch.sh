#!/bin/sh
# Fetches Coal and DAQP into a folder, for library_bench: bench/library/fetch.sh FOLDER
# Nothing is installed; the folder goes to CMake as MJCF_PDG_BENCH_LIBRARIES. 350 MB, most of it Boost's headers.
set -eu
mkdir -p "$1"
cd "$1"
python3 -m pip download --quiet --no-deps --only-binary=:all: --dest wheels \
  libcoal==3.0.3 cmeel-boost==1.90.0 cmeel-assimp cmeel-octomap cmeel-qhull cmeel-zlib
for wheel in wheels/*.whl; do python3 -m zipfile -e "$wheel" .; done  # all into cmeel.prefix
# pip makes the metadata of a source package before it gives it away, which takes minutes.
python3 -m pip download --quiet --no-deps --no-binary=:all: --dest sources daqp==0.11.0
tar -xzf sources/daqp-0.11.0.tar.gz
mkdir -p daqp/include daqp/lib
cp -r daqp-0.11.0/csrc/include daqp/include/daqp
for source in daqp-0.11.0/csrc/src/*.c; do
  cc -O3 -DPROFILING -fPIC -Idaqp/include/daqp -c "$source" -o "daqp/$(basename "$source" .c).o"
done
ar rcs daqp/lib/libdaqp.a daqp/*.o
