"$ISOSHADE" verify scene.json --update
