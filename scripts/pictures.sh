#!/usr/bin/env bash
# Renders all images in the repository that isoshade makes: the patterns in graphs/textures, then the images of README.md,
# then the screenshot of a page, for which the packages chromium and chromium-driver have to be installed.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/build.sh release isoshade
isoshade=build/release/isoshade
for pattern in ivy planks shingles stones; do
  "$isoshade" --quiet render "graphs/textures/${pattern}_tile.json" -o "graphs/textures/$pattern.png"
done
for scene in environment_balls cartoon_village fog_valley fog_village transparent stylised_highlights fur motion_blur; do
  "$isoshade" --quiet render "graphs/scenes/$scene.json" --samples 16 -o "docs/$scene.png"
done
"$isoshade" --quiet render graphs/scenes/depth_of_field.json --size 1280x720 --samples 16 -o docs/depth_of_field.png
# Strokes are as wide as samples.
"$isoshade" --quiet render graphs/scenes/sketch.json --samples 4 -o docs/sketch.png
screenshots=$(mktemp -d)
trap 'rm -rf "$screenshots"' EXIT
python3 tests/page_test.py "$isoshade" graphs --screenshots "$screenshots"
cp "$screenshots/cartoon_tub.png" docs/page.png
