#!/usr/bin/env bash
# Measures run time and error and writes docs/bench.svg, the plot in README.md, and docs/bench.csv. Takes minutes; run it
# on an idle machine. Arguments are passed to `isoshade bench`.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/setup.sh
scripts/build.sh release isoshade
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
build/release/isoshade bench -o "$folder" "$@"
cp "$folder/bench.svg" "$folder/bench.csv" docs/
