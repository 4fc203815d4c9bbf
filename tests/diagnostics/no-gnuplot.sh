PATH=/nowhere "$ISOSHADE" bench --only ggx_d -o "$OUT/bench"
