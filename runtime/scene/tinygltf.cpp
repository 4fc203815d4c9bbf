// SPDX-License-Identifier: Apache-2.0
// The header-only tinygltf without its readers of images and files, which definitions in CMakeLists.txt disable for all
// that include it. Debian's library includes them, and links stb.
#include <fstream>  // for its writers, which cannot be disabled

#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
