#!/usr/bin/env bash
# Renders every picture that the project keeps and isoshade makes: the patterns of graphs/textures, then README's.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/build.sh release isoshade
isoshade=build/release/isoshade
for pattern in planks shingles stones; do
  "$isoshade" --quiet render "graphs/textures/${pattern}_tile.json" -o "graphs/textures/$pattern.png"
done
for scene in material_balls cartoon_village fog_valley fog_village; do
  "$isoshade" --quiet render "graphs/scenes/$scene.json" --samples 16 -o "docs/$scene.png"
done
