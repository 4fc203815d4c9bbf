"$ISOSHADE" render scene.json --set ball.rougness=0.5 --backend interpreter -o "$OUT/a.png"
