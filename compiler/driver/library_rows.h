// SPDX-License-Identifier: Apache-2.0
// The function documents of the library as rows of a node table, for the manual and the schema.
#pragma once

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "compiler/check/library.h"
#include "compiler/nodes/row.h"

namespace isoshade::driver {

class LibraryRows {
 public:
  /// Reads every document of the library; reports and skips those with errors.
  LibraryRows(check::Library& library, support::Diagnostics& diagnostics);
  LibraryRows(const LibraryRows&) = delete;
  LibraryRows& operator=(const LibraryRows&) = delete;

  /// Sorted by name. The doc of an input includes its range. These rows cannot be lowered.
  const std::vector<nodes::Row>& rows() const { return rows_; }

 private:
  nodes::Port port_of(const graph::Input& input);
  std::string_view keep(std::string text) { return texts_.emplace_back(std::move(text)); }

  std::deque<std::string> texts_;  ///< referenced by the rows
  std::vector<nodes::Row> rows_;
};

}  // namespace isoshade::driver
