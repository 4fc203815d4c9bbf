PATH=/nowhere "$ISOSHADE" draw bad-table-function.json -o "$OUT/a.svg"
