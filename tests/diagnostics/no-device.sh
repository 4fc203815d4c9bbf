"$ISOSHADE" render scene.json --backend vulkan --device "Voodoo 2" -o "$OUT/a.png"
