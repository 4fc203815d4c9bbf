// SPDX-License-Identifier: Apache-2.0
// Which maps of the environment a document reads, so that the others need not be made.
#pragma once

#include <cstddef>
#include <vector>

#include "compiler/check/typed_graph.h"

namespace isoshade::driver {

/// The sharp map is the one of the radiance at roughness 0. All others are blurred: those of the radiance at greater
/// roughnesses, and the irradiance.
struct EnvironmentReads {
  bool any = false;
  bool blurred = false;  ///< blurred maps, whatever the values of the parameters are
  /// Indices of parameter fields that are roughnesses: blurred maps are read only where one of these is above 0.
  std::vector<size_t> roughnesses;
};

EnvironmentReads environment_reads(const check::TypedGraph& typed);

}  // namespace isoshade::driver
