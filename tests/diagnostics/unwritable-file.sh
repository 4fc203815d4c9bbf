"$ISOSHADE" render scene.json --backend interpreter -o /nowhere/a.png
