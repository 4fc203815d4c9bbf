// SPDX-License-Identifier: Apache-2.0
// Vulkan-Hpp with the parts switched off that only cost compile time. It takes seconds to read: include it in
// as few files as possible, and in no header that others include.
#pragma once

#define VULKAN_HPP_NO_STRUCT_CONSTRUCTORS  // structs are aggregates: .member = value
#define VULKAN_HPP_NO_STRUCT_SETTERS
#define VULKAN_HPP_NO_SPACESHIP_OPERATOR
#define VULKAN_HPP_NO_SMART_HANDLE
#include <vulkan/vulkan_raii.hpp>
