// SPDX-License-Identifier: Apache-2.0
// Functions of pure shaders, and the runtime's programs that compute the same for each row of a table.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "compiler/driver/shader.h"

namespace isoshade::equivalence {

/// Rows that follow each other and have the same parameters: a batch of lanes.
inline constexpr size_t rows_of_a_batch = 16;

/// A function of a shader, with a column of the table for each field of its point and of Parameters.
struct Subject {
  std::string name;      ///< unique: also of the runtime's program
  std::string function;  ///< as called in C++
  std::string point;     ///< the struct in C++
  std::vector<emit::PureField> points, parameters;
  const driver::Shader* shader = nullptr;
  driver::Program runtime;
  ir::Type result;
  int stride = 0, words = 0;
};

/// The shaders of some documents, and all their functions.
struct Subjects {
  std::vector<std::unique_ptr<driver::Shader>> shaders;
  std::vector<Subject> all;
};

/// Of the effects and posts among some documents.
Subjects subjects_of(const std::vector<std::filesystem::path>& paths,
                     driver::Division division = driver::Division::native);

int words_of(const std::vector<emit::PureField>& fields);
/// Random points and parameters, within their ranges.
std::vector<int32_t> table_of(const Subject& subject, size_t rows);

}  // namespace isoshade::equivalence
