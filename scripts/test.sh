#!/usr/bin/env bash
# Sets up, builds and runs the tests. --full adds the slow ones: the clang build, the sanitizer build, exhaustive sweeps,
# valgrind on damaged files.
set -euo pipefail
cd "$(dirname "$0")/.."
full=0
case "${1:-}" in
  "") ;;
  --full) full=1 ;;
  *) echo "usage: scripts/test.sh [--full]" >&2; exit 2 ;;
esac

scripts/setup.sh
scripts/build.sh release
if [ "$full" -eq 1 ]; then
  for preset in clang asan; do
    scripts/build.sh "$preset"
    ctest --preset "$preset" --parallel "$(nproc)"
  done
  export ISOSHADE_FULL=1
  ctest --preset asan --tests-regex '^Documents|DamagedFiles'
  # Finds reads of uninitialised memory, also in libraries built without a sanitizer. Libjpeg's SIMD code is disabled,
  # because it also reads past the end of a row; valgrind cannot tell that no pixel depends on it (scene_jpeg_test can).
  JSIMD_FORCENONE=1 ISOSHADE_DAMAGED=500 valgrind --quiet --error-exitcode=1 build/release/tests/images_fuzz_test
fi
ctest --preset release --parallel "$(nproc)"
