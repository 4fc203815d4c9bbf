// SPDX-License-Identifier: Apache-2.0
// GLSL to SPIR-V 1.3 for Vulkan 1.1, by glslang in this process.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/support/diagnostics.h"

namespace isoshade::glsl {

enum class ShaderKind : uint8_t { vertex, fragment, compute };
std::string_view name(ShaderKind kind);

/// Whether a shader promises bits. One that does begins with head(); a module of it without SignedZeroInfNanPreserve 32
/// would be a bug of ours, so it aborts.
enum class Contract : uint8_t {
  within,
  outside,
  free  ///< promises nothing, and drivers may contract and reorder operations
};

/// The module with entry point `main`, validated by SPIRV-Tools. Not optimised: every operation is as in the text, and
/// those on floats are NoContraction unless `contract` is free, whether the text says `precise` or not. The same text
/// gives the same words on every machine, in time linear in its length. Thread-safe.
///
/// A text that does not compile is reported (bad-shader): a graph may be larger than glslang can take.
/// `what` names the text in that report: `the pixel stage of "fur" (fur.json)`.
std::optional<std::vector<uint32_t>> compile_spirv(const std::string& glsl, ShaderKind kind,
                                                   support::Diagnostics& diagnostics,
                                                   const std::string& what = "a shader",
                                                   Contract contract = Contract::within);

/// What decides the words that compile_spirv() makes of a text, beside the text and its kind: the versions of glslang and
/// SPIRV-Tools, and the source of compile_spirv() with its options. For the keys of caches.
std::string spirv_compiler();

/// A hash of the file that defines compile_spirv().
std::string_view hash_of_spirv_source();

/// How many operations on floats the text leaves to a compiler that follows `precise` to contract, or nothing where it
/// does not compile. Of our texts none: users compile them by compilers of their own. May take exponential time.
std::optional<size_t> count_contractible(const std::string& glsl, ShaderKind kind,
                                         support::Diagnostics& diagnostics);

}  // namespace isoshade::glsl
