"$ISOSHADE" render scene.json --set background=0,0,0,0 --backend interpreter -o "$OUT/a.jpg"
