// SPDX-License-Identifier: Apache-2.0
// Tests whether a device computes what the contract requires: small shaders run on it, and the host compares every bit.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/driver/program.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::vulkan {

class Device;

struct Check {
  std::string name;  ///< "comparisons (fragment)"
  bool passed = false;
  std::string detail;  ///< the observed result
};

struct Probe {
  /// Native if the device rounds every probed quotient and root correctly.
  driver::Division division = driver::Division::exact;
  std::vector<Check> checks;
  bool cached = false;  ///< an earlier run of isoshade made the checks

  /// Whether images of the device have the bits of every other device.
  bool passed() const {
    return std::all_of(checks.begin(), checks.end(), [](const Check& check) { return check.passed; });
  }
};

/// Throws std::exception if Vulkan fails; returns nothing, with a diagnostic, if a shader does not compile.
std::optional<Probe> run_probe(Device& device, support::Diagnostics& diagnostics);

/// The result of a device that passed, as text, and back: nothing if the text is no such result.
std::string to_text(const Probe& probe);
std::optional<Probe> probe_from_text(std::string_view text);

/// A hash of the sources on which the result depends.
std::string_view hash_of_probe_sources();

/// Reports unproven-device with the checks that failed.
void report_unproven(const Probe& probe, const std::string& device, support::Diagnostics& diagnostics);

}  // namespace isoshade::vulkan
