#!/usr/bin/env bash
# Sets up, builds, renders the material balls to out/ on the CPU and on Vulkan, and compares every bit.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/setup.sh
scripts/build.sh release isoshade

isoshade=build/release/isoshade
scene=graphs/scenes/material_balls.json
mkdir -p out
"$isoshade" compile graphs/materials/cook_torrance.json -o out/cook_torrance --quiet
for backend in cpu vulkan; do
  "$isoshade" render "$scene" --backend "$backend" -o "out/material_balls.$backend.png"
done
verdict=0
"$isoshade" verify "$scene" --report out/report || verdict=$?
echo
echo "images     out/material_balls.cpu.png  out/material_balls.vulkan.png"
echo "shaders    out/cook_torrance/cook_torrance.glsl  cook_torrance.h"
exit "$verdict"
