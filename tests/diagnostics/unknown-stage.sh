"$ISOSHADE" compile unused-node.json -Wno-unused-node --dump-after foldd -o "$OUT"
