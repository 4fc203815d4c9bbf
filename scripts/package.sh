#!/usr/bin/env bash
# Builds the Debian package: build/release/isoshade_VERSION_ARCHITECTURE.deb
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/setup.sh
scripts/build.sh release isoshade isoshade_compiler isoshade_runtime
cd build/release
cpack -G DEB
