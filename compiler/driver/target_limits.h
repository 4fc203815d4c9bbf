// SPDX-License-Identifier: Apache-2.0
// How large a program each target bears.
#pragma once

#include <cstdint>

#include "compiler/driver/program.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::driver {

enum class Target : uint8_t { vulkan, cpu, interpreter };

/// Operations of a program with all its calls expanded (ir/expansion.h).
///
/// Every Vulkan driver expands all calls. With glslang, lavapipe (Mesa 22.3, LLVM 15) takes 0.1 to 0.35 ms and 10 to 17 KB
/// for each operation: 2.3 s and 418 MB for a tree of calls with 16,384, 7.5 s and 336 MB for a sum with 20,000. On one lane the interpreter takes some 5 ns for each,
/// in every pixel; C++ keeps large functions as calls, so that only its running time counts them.
inline constexpr uint64_t most_operations_on_vulkan = 24'576;
inline constexpr uint64_t most_operations_on_cpu = 4'194'304;
inline constexpr uint64_t most_operations_on_interpreter = 262'144;
/// Operations that stand in the C++ of a program: g++ 12 takes 0.3 ms for each (emit/cpp.h), so that these are 10 s.
inline constexpr uint64_t most_operations_in_cpp = 32'768;

/// Whether a target bears a program; reports the node that calls the most if not. `division`: an exact one is some 40
/// operations.
bool within_limits(const Program& program, Target target, Division division,
                   support::Diagnostics& diagnostics);

}  // namespace isoshade::driver
