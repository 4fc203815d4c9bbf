// SPDX-License-Identifier: Apache-2.0
// Functions that are measured: documents of graphs/, nodes, or rows of functions.def, on every backend by the same path
// as `isoshade eval`.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "backends/reference/real.h"
#include "compiler/driver/driver.h"

namespace isoshade::accuracy {

class Subject {
 public:
  /// "library/brdf/ggx_d", a document of graphs/.
  static Subject document(const std::string& name);
  /// A function of these inputs, each "name" (a float), "name:vector3" or "name:color3", whose result is an
  /// expression.
  static Subject expression(const std::vector<std::string>& inputs, const std::string& code);
  /// A row of functions.def on floats.
  static Subject row(const std::string& name, size_t arguments);

  /// The same function by the bodies of another tier; subjects are of the default one.
  Subject in_tier(functions::Tier tier) const;

  const std::string& name() const { return name_; }
  /// How many words a row of inputs or results has.
  size_t inputs() const { return words_of(program_.inputs); }
  size_t results() const { return words_of(program_.results); }

  /// The results of many rows of inputs, one after the other. Every backend computes them: cpu of 1 lane and 16,
  /// vulkan, interpreter. Fails the test where they differ in a bit. Denormal inputs are zeros, as eval reads them.
  std::vector<float> operator()(const std::vector<float>& inputs) const;

  /// The same on the fastest backend alone, for sweeps that the others would take too long for.
  std::vector<float> on_one_backend(const std::vector<float>& inputs) const;

  /// The same in 57 digits. Not of rows.
  std::vector<reference::Real> exact(const std::vector<float>& inputs) const;

 private:
  Subject(std::string name, std::string source, size_t arguments = 0);
  static size_t words_of(const std::vector<driver::Field>& fields);
  driver::Program compile(functions::Tier tier, bool reference = false) const;
  driver::Program compile_row(functions::Tier tier) const;

  std::string name_;
  std::string source_;    ///< the text of a document; empty: a row
  size_t arguments_ = 0;  ///< of a row
  driver::Program program_;
};

/// A document of graphs/ as a path.
std::string graph_path(const std::string& name);

}  // namespace isoshade::accuracy
