// SPDX-License-Identifier: Apache-2.0
// A host of pure shaders, written three times: in GLSL, in C++ and in IR.
#pragma once

#include <map>
#include <string>

#include "compiler/interface/host.h"
#include "compiler/lower/kernel.h"

namespace isoshade::equivalence {

/// The functions of the host that a pure shader declares.
std::string glsl_host_of(const std::string& pure);
/// `struct Host`, and functions that read and write lanes.
extern const char* const cpp_host;
/// Gives what the module asks its host for a body. `host`: by name in the module.
void define_host(ir::Module& module, const std::map<std::string, interface::HostFunction>& host);
/// What the host answers for a parameter of a document's function.
ir::ValueId answer(lower::Kernel& k, const interface::place::Host& asked);

}  // namespace isoshade::equivalence
