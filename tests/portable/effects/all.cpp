// SPDX-License-Identifier: Apache-2.0
//
// The three effects in one translation unit.
#include "cartoon.cpp"
#include "cook_torrance.cpp"
#include "gltf_pbr.cpp"
