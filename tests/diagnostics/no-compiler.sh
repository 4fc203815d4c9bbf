"$ISOSHADE" render scene.json --cxx /nowhere/c++ -o "$OUT/a.png"
