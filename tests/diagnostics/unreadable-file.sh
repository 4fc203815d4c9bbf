"$ISOSHADE" compile . -o "$OUT"
