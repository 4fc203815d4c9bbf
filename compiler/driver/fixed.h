// SPDX-License-Identifier: Apache-2.0
// Values of parameters that are known when programs are compiled: what follows from them is computed then, and what
// they switch off is no part of the programs.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "compiler/driver/parameter_block.h"
#include "compiler/interface/binding.h"
#include "compiler/interface/pass_state.h"

namespace isoshade::check {
struct TypedGraph;
}
namespace isoshade::lower {
struct Lowered;
}

namespace isoshade::driver {

/// By word of a record (ParameterBlock): its value, if it is fixed, as records hold it. Empty: none is fixed. An image
/// is fixed only to -1. The records have all words nonetheless.
using FixedWords = std::vector<std::optional<float>>;

/// Whether a record could have given these values.
bool agrees(const FixedWords& fixed, std::span<const float> record);

/// Whether all words of a field are fixed.
bool is_fixed(const FixedWords& fixed, const ParameterBlock& block, size_t field);

/// Makes the parameters of a document's function constants where they are fixed: exactly what kernels would have loaded
/// from the record. The interface loses their bindings. `repeat`: of the pass, if there is one.
void fix_parameters(ir::Module& module, interface::Interface& interface, const ParameterBlock& block,
                    const FixedWords& fixed, const interface::Repeat* repeat = nullptr);

/// Fixes values in what is lowered of a document, or of a pass: prove::Change. Empty if none is fixed. `document` must outlive
/// it.
std::function<void(lower::Lowered& lowered, size_t pass)> fixing(const check::TypedGraph& document, FixedWords fixed);

/// Drops the parameters that a document's function does not read, with their bindings; what calls it is made anew.
void drop_unread(ir::Function& function, interface::Interface& interface);

}  // namespace isoshade::driver
