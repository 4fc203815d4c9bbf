// SPDX-License-Identifier: Apache-2.0
// tinygltf, which is a header, without its readers of images and of files: CMakeLists.txt says so to all that include
// it. Debian's library of it has them, and links stb.
#include <fstream>  // for its writers, which it does not leave out

#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
