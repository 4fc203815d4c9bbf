#!/usr/bin/env bash
# Measures run time against error and draws the picture of README.md: docs/bench.svg, docs/bench.csv. Minutes; on a
# machine that does nothing else. Arguments go to `isoshade bench`.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/setup.sh
scripts/build.sh release isoshade
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
build/release/isoshade bench -o "$folder" "$@"
cp "$folder/bench.svg" "$folder/bench.csv" docs/
