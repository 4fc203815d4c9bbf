"$ISOSHADE" render scene.json --set ball.roughness --backend interpreter -o "$OUT/a.png"
