// SPDX-License-Identifier: Apache-2.0
// The node table's programs: every node that function documents may have, at every choice of types, from
// documents through the whole compiler.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "compiler/driver/program.h"

namespace isoshade::conformance {

struct NodeCase {
  std::vector<std::string> nodes;  ///< "add vector3"
  std::vector<std::string> words;  ///< what each result word is: "add vector3.1"
  driver::Program program;
};

/// As few programs as hold all nodes, of at most 32 result words. Colours are vectors under another name, so
/// examples that only differ in that are one. A bundle that does not compile is a failure of the test.
std::vector<NodeCase> node_cases();

/// `rows` records for the program's inputs, of the floats and ints of inputs(); booleans are 0 or 1.
std::vector<int32_t> node_inputs(const driver::Program& program, size_t rows);

}  // namespace isoshade::conformance
