// SPDX-License-Identifier: Apache-2.0
// C++20 over runtime/lanes.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "compiler/emit/printer.h"
#include "compiler/emit/pure.h"
#include "compiler/emit/target.h"
#include "compiler/ir/module.h"

namespace isoshade::cpp {

const emit::Target& target();

/// Spells the functions of a pure shader.
std::unique_ptr<emit::Language> linked_language(const ir::Module& module, std::span<const uint32_t> entries);
/// The namespace of a pure shader.
std::string space(const emit::PureShader& shader);
/// A pure shader, whole: a header.
std::string pure(const emit::PureShader& shader);

/// A program of more operations than this with all its calls expanded (ir/expansion.h) is large. All functions of others
/// are inlined, so a compiler sees one function of that length, for which g++ 12 -O2 takes time that grows with the
/// square: for sums of 1,000, 2,500 and 5,000 terms (two operations each, 8x2 lanes) 1.0, 15 and more than 100 s. Cut
/// into parts of 50 operations it takes 0.3 ms for each operation in one register a value and 0.6 ms in two.
inline constexpr uint64_t large_program = 6'000;
/// In a large program a function of more operations than this is called, not inlined,
inline constexpr uint64_t most_inlined_in_large = 32;
/// and a block of more is cut (passes/passes.h).
inline constexpr uint64_t longest_in_large = 50;

/// How many operations a compiler sees in a program's C++: what is called stands there once.
uint64_t operations(const ir::Module& module, uint32_t entry);

/// The entry function and all that it calls as templates over the float type F, for use inside a namespace
/// that says `using namespace isoshade::lanes`: engine-neutral text.
std::string functions(const ir::Module& module, uint32_t entry);
/// `texts` receives what print_functions (printer.h) gives.
std::string functions(const ir::Module& module, uint32_t entry, std::vector<emit::FunctionText>& texts);

/// `struct Buffers` with a member for each buffer of the module.
std::string buffers(const ir::Module& module);

}  // namespace isoshade::cpp
