printf 'x,v.x,v.y\n1,2,3\n' > "$OUT/table.csv"
"$ISOSHADE" eval bad-table-function.json --inputs "$OUT/table.csv" --backend interpreter
