// SPDX-License-Identifier: Apache-2.0
// Effects and posts with their programs, kept for scenes that are planned anew.
#pragma once

#include <algorithm>
#include <deque>
#include <string>

#include "compiler/driver/driver.h"

namespace isoshade::render {

/// Makes the programs of documents, or finds those that it has made of the same document for the same options and fixed
/// values. Their numbers (driver::Program::number) are the same then. All that calls it compiles with one library.
class Compiled {
 public:
  void make(driver::Effect& effect, const driver::CompileOptions& options) {
    make(effect, options, effects_, [&] { driver::make_programs(effect, options); });
  }
  void make(driver::Post& post, const driver::CompileOptions& options) {
    make(post, options, posts_, [&] { driver::make_program(post, options); });
  }

 private:
  static constexpr size_t most_kept = 32;  ///< of each kind; the oldest go first

  template <class Document>
  struct Kept {
    std::string key;
    Document document;  ///< keeps what the key points to
  };

  static std::string key_of(const check::TypedGraph& typed, const driver::CompileOptions& options);

  template <class Document, class Make>
  static void make(Document& document, const driver::CompileOptions& options, std::deque<Kept<Document>>& kept,
                   const Make& make_anew) {
    std::string key = key_of(*document.typed, options);
    const auto found = std::ranges::find(kept, key, &Kept<Document>::key);
    if (found != kept.end()) {
      document = found->document;
      return;
    }
    make_anew();
    if (kept.size() == most_kept) kept.pop_front();
    kept.push_back({std::move(key), document});
  }

  std::deque<Kept<driver::Effect>> effects_;
  std::deque<Kept<driver::Post>> posts_;
};

}  // namespace isoshade::render
