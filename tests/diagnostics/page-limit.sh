"$ISOSHADE" page scene.json --samples 4 -o "$OUT/a.html"
