#!/usr/bin/env bash
# Measures run time and error and writes docs/bench.svg and docs/frames.svg, the plots in README.md, their tables
# (docs/bench.csv, docs/frames.csv), and the table of ratios in README.md. Takes half an hour; run it on an idle machine.
# Arguments are passed to `isoshade bench`.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/setup.sh llvm spirv-cross  # for the port bound and for C++ to compare with
scripts/build.sh release isoshade
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
build/release/isoshade bench -o "$folder" "$@"
build/release/isoshade bench --frames -o "$folder" "$@"
cp "$folder"/{bench,frames}.{svg,csv} docs/
awk -v table="$folder/bench.md" '
  /<!-- end of bench.md -->/ { inside = 0 }
  !inside { print }
  /<!-- bench.md -->/ { inside = 1; while ((getline line < table) > 0) print line }
' README.md > "$folder/README.md"
cp "$folder/README.md" README.md
