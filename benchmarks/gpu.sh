#!/usr/bin/env bash
# Press half-spaces of 4096² to 16384² on one NVIDIA card, in some ten minutes: see gpu.py for what is measured.
#
#   benchmarks/gpu.sh [WHEELS] [FLAGS OF gpu.py]
#
# The machine has python3 with PyTorch, CuPy, numpy, scipy, pandas and numba, and needs no package index. What else Asperity
# imports comes as wheels in the folder WHEELS, packed where there is an index, for the Python of that machine:
#
#   pip download --no-deps --only-binary=:all: --python-version 3.12 --implementation cp --dest WHEELS \
#     --platform manylinux_2_28_x86_64 --platform manylinux_2_17_x86_64 --platform manylinux2014_x86_64 \
#     xarray zarr msgspec numcodecs donfig google-crc32c array-api-compat annotated-types
set -euo pipefail
packages="" here=$(dirname "$0")
if [ -d "${1:-}" ]; then
  packages=$(mktemp -d)
  trap 'rm -rf "$packages"' EXIT
  python3 -m pip install --quiet --no-index --no-deps --target "$packages" "$1"/*.whl
  shift
fi
nvidia-smi --query-gpu=name,memory.total,driver_version --format=csv,noheader || echo "no NVIDIA card here"
PYTHONPATH=$here/../src:$packages PYTHONUNBUFFERED=1 python3 "$here/gpu.py" "$@"
