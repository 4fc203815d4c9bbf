printf '#!/bin/sh\n[ "$1" = --version ] && echo c++ 1.0 && exit\necho "no space for temporary files"; exit 1\n' > "$OUT/c++"
chmod +x "$OUT/c++"
XDG_CACHE_HOME="$OUT" "$ISOSHADE" verify scene.json --backends cpu,interpreter --lanes 1 --cxx "$OUT/c++"
