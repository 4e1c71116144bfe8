#!/usr/bin/env bash
set -euo pipefail
# shellcheck disable=SC2086  # CMAKE_ARGS holds many words
cmake -B build -G Ninja $CMAKE_ARGS -DCMAKE_BUILD_TYPE=Release -DTERACELL_UNITY=ON -DTERACELL_WEB=ON -DTERACELL_LIBRARY=ON -DSTB_INCLUDE_DIR="$SRC_DIR/stb-include"
cmake --build build -j "$CPU_COUNT"
cmake --install build
