#!/usr/bin/env bash
# Installs the packages of Debian 12 (or Ubuntu) that isoshade needs to build, run and test. Does nothing if all are
# installed. Uses sudo only if it is needed. Arguments are further packages.
set -euo pipefail

packages=(
  # building
  g++ cmake ninja-build pkg-config
  nlohmann-json3-dev libfmt-dev libglm-dev libcli11-dev libspng-dev libjpeg-dev libgif-dev libopenexr-dev zlib1g-dev libtinygltf-dev
  libtbb-dev libssl-dev libmpfr-dev
  glslang-dev spirv-tools spirv-headers libvulkan-dev
  # running: Vulkan on the CPU, and the loader for other devices
  mesa-vulkan-drivers libvulkan1
  # packaging (scripts/package.sh)
  dpkg-dev file
  # drawing graphs and plots
  graphviz gnuplot-nox
  # testing
  libgtest-dev libbenchmark-dev glslang-tools clang valgrind vulkan-validationlayers python3-jsonschema
  g++-aarch64-linux-gnu qemu-user
  chromium chromium-driver
  "$@"
)

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
done
[ "${#missing[@]}" -eq 0 ] && exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "setup: these packages are missing, and sudo is not installed: ${missing[*]}" >&2; exit 2; }
  as_root=(sudo)
fi
echo "setup: installing ${missing[*]}"
"${as_root[@]}" apt-get update -q
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
