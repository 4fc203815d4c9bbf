// SPDX-License-Identifier: Apache-2.0
// The front end and what documents declare, for the files of this folder that compile them.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "compiler/driver/driver.h"

namespace isoshade::driver {

/// JSON text -> Document -> Graph -> TypedGraph. Reports a document that is not of kind `wanted`, if given.
std::shared_ptr<const check::TypedGraph> read_graph(const support::Source& source,
                                                    std::optional<graph::DocumentKind> wanted,
                                                    const CompileOptions& options, support::Diagnostics& diagnostics);

/// Without a default.
Field field(const std::string& name, graph::Type type);
std::vector<Field> input_fields(const check::TypedGraph& typed);
std::vector<Field> output_fields(const check::TypedGraph& typed);
std::vector<Image> images_of(const check::TypedGraph& typed);
/// What the record of an effect or a post holds, with the defaults.
ParameterBlock parameter_block(const check::TypedGraph& typed);

}  // namespace isoshade::driver
