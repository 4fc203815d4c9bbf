// SPDX-License-Identifier: Apache-2.0
// Limits on program size, by target.
#pragma once

#include <cstdint>

#include "compiler/driver/program.h"
#include "compiler/driver/shader.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::driver {

enum class Target : uint8_t { vulkan, cpu, interpreter };

/// Operations of a program with all its calls expanded (ir/expansion.h).
///
/// Vulkan drivers expand all calls. With glslang, lavapipe (Mesa 22.3, LLVM 15) takes 0.1 to 0.35 ms and 10 to 17 KB
/// per operation: 2.3 s and 418 MB for a tree of calls with 16,384 operations, 7.5 s and 336 MB for a sum with 20,000. The
/// interpreter takes about 0.1 ns per operation and pixel on one thread. C++ keeps large functions as calls, so the expanded
/// operations count only at run time.
inline constexpr uint64_t most_operations_on_vulkan = 24'576;
inline constexpr uint64_t most_operations_on_cpu = 4'194'304;
inline constexpr uint64_t most_operations_on_interpreter = 262'144;
/// Operations in the C++ text of a program: g++ 12 takes 0.3 ms for each (targets/cpp/cpp.h), so at most 10 s.
inline constexpr uint64_t most_operations_in_cpp = 32'768;

/// Whether a program is within the limits of a target; if not, reports the node with the most operations. An exact
/// `division` counts as about 40 operations.
bool within_limits(const Program& program, Target target, Division division,
                   support::Diagnostics& diagnostics);

/// The same for each function of a pure shader.
bool within_limits(const Shader& shader, const emit::Target& target, Division division,
                   support::Diagnostics& diagnostics);

}  // namespace isoshade::driver
