// SPDX-License-Identifier: Apache-2.0
// Layout of large diagrams.
#pragma once

#include <cstddef>
#include <vector>

namespace isoshade::driver {

/// Arranges boxes in columns, each to the right of all boxes that link to it, in linear time except for a sort of each
/// column. Graphviz finds shorter links, but takes minutes for some hundred boxes.
class BoxLayers {
 public:
  /// Adds a box with this number of text rows; boxes are numbered from 0.
  void add_box(size_t rows) { rows_.push_back(rows); }
  void add_link(size_t from, size_t to) { links_.push_back({from, to}); }

  /// The centre of a box, in points, y upwards.
  struct BoxPosition {
    int x, y;
  };
  /// The position of each box. Links must be acyclic.
  std::vector<BoxPosition> positions() const;

 private:
  struct Link {
    size_t from, to;
  };
  std::vector<size_t> rows_;
  std::vector<Link> links_;
};

}  // namespace isoshade::driver
