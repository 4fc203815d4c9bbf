#!/usr/bin/env bash
# Sets up, builds and runs the tests. --full adds what takes long: the clang build, the sanitizer build, exhaustive
# sweeps, valgrind over damaged files.
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
  # Memory that nobody wrote, also by libraries that no sanitizer sees into. Without libjpeg's vector instructions: they
  # compute on what lies behind a row, too, and valgrind does not see that no pixel is made of it (scene_jpeg_test does).
  JSIMD_FORCENONE=1 ISOSHADE_DAMAGED=500 valgrind --quiet --error-exitcode=1 build/release/tests/images_fuzz_test
fi
ctest --preset release --parallel "$(nproc)"
