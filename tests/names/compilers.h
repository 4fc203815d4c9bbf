// SPDX-License-Identifier: Apache-2.0
// The compilers that take the texts.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "compiler/driver/shader.h"

namespace isoshade::names {

/// With ISOSHADE_FULL set: clang++ takes all texts, not some, and macros_of_headers() are words.
bool is_full();

/// Texts of programs. GLSL is compiled when it is added, C++ all at once.
class Texts {
 public:
  void add(const driver::Program& program);
  void add(const driver::Shader& shader);
  /// g++ over every text of C++, many in each file, after the headers of the standard libraries; and clang++. glslangValidator
  /// over every text of GLSL ES.
  void compile();

  size_t glsl_count() const { return glsl_; }
  size_t es_count() const { return es_.size(); }
  size_t cpp_count() const { return cpp_.size() + headers_.size(); }
  size_t clang_count() const { return clang_; }

 private:
  size_t glsl_ = 0, clang_ = 0;
  std::vector<std::string> cpp_;
  struct Header {
    std::string space;  ///< its namespace
    std::string text;
  };
  std::vector<Header> headers_;  ///< pure shaders
  struct EsText {
    const char* ending;
    std::string text;
  };
  std::vector<EsText> es_;  ///< GLSL ES: pure shaders and forward pairs
};

/// Every macro that g++ has after those headers.
std::set<std::string> macros_of_headers();

}  // namespace isoshade::names
