#!/usr/bin/env bash
# Compiles everything without precompiled headers and batches, in Debug: no_precompiled_headers.sh SOURCE BUILD
set -euo pipefail
cmake -S "$1" -B "$2" -G Ninja -DCMAKE_BUILD_TYPE=Debug -DMORTISE_PCH=OFF -DMORTISE_UNITY=OFF >/dev/null
ninja -C "$2" -k 0 | tail -n 60
