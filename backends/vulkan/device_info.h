// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "compiler/support/diagnostics.h"

namespace isoshade::vulkan {

/// A Vulkan device as the `devices` command lists it.
struct DeviceInfo {
  int index = 0;       ///< what `--device` takes, besides a part of the name
  std::string name;    ///< "llvmpipe (LLVM 15.0.6, 256 bits)"
  std::string driver;  ///< "llvmpipe Mesa 22.3.6 (LLVM 15.0.6)"
  std::string api;     ///< "1.3.230"
  bool cpu = false;    ///< a software device
};

/// The devices of this machine in the order of their index; empty, with a diagnostic, where there is no Vulkan.
std::vector<DeviceInfo> list_devices(support::Diagnostics& diagnostics);

/// Whether `--device` names this device: by its number, or by a part of its name in any case.
bool matches(const DeviceInfo& info, std::string_view selector);

/// Reports no-device, with what to install.
support::Diagnostic& report_unusable(std::string_view why, support::Diagnostics& diagnostics);

}  // namespace isoshade::vulkan
