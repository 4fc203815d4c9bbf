// SPDX-License-Identifier: Apache-2.0
// Scalar C++ to compare with: written by hand with GLM, and made of our SPIR-V by SPIRV-Cross. Both are called by the
// program that calls our own function, in its place, and compiled with -O3 for this processor, without the rules of the
// contract.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "backends/cpu/kernel.h"
#include "runtime/bench/subject.h"

namespace isoshade::bench {

enum class PeerKind : uint8_t { glm, spirv_cross };
inline constexpr std::array peer_names{"glm", "spirv-cross"};
constexpr const char* name(PeerKind kind) { return peer_names[static_cast<size_t>(kind)]; }

/// Whether there is a peer of this kind for the effect.
bool has_peer(PeerKind kind, const Subject& subject);

/// A loaded program. It runs on the calling thread.
class PeerProgram {
 public:
  /// The table program or the compute program of a subject, of which `function` names the function that is replaced.
  /// `table`: the table program, whose SPIR-V is translated. Nothing, with the reason in `why`, if a tool or GLM is missing.
  static std::unique_ptr<PeerProgram> make(PeerKind kind, const Subject& subject, const driver::Program& program,
                                           const driver::Program& table, const std::string& function,
                                           const std::string& compiler, support::Seconds limit, std::string& why);

  void run(std::span<const int32_t> inputs, size_t rows, std::vector<int32_t>& results) const;

 private:
  PeerProgram(std::unique_ptr<cpu::Kernel> kernel, size_t words) : kernel_(std::move(kernel)), words_(words) {}
  std::unique_ptr<cpu::Kernel> kernel_;
  size_t words_;  ///< of a row of results
};

}  // namespace isoshade::bench
