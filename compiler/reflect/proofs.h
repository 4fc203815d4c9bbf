// SPDX-License-Identifier: Apache-2.0
// What can be proved of a document, for its reflection.
#pragma once

#include <optional>

#include "compiler/check/typed_graph.h"
#include "compiler/functions/tier.h"
#include "compiler/reflect/reflection.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::reflect {

/// What `isoshade check` finds of a document. Takes seconds where much is left to prove. Reports a document that is too
/// large and returns nothing.
std::optional<List<Proof>> proofs_of(const check::TypedGraph& graph, functions::Tier tier,
                                     support::Diagnostics& diagnostics);

}  // namespace isoshade::reflect
