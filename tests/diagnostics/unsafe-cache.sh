mkdir -p "$OUT/cache/isoshade" && chmod 777 "$OUT/cache/isoshade"
XDG_CACHE_HOME="$OUT/cache" "$ISOSHADE" render scene.json --lanes 1 -o "$OUT/a.png"
