// SPDX-License-Identifier: Apache-2.0
// Where the boxes of a large picture go.
#pragma once

#include <cstddef>
#include <vector>

namespace isoshade::driver {

/// Boxes in columns, each to the right of all that link to it, in time linear in boxes and links (but for a sort of
/// each column). Graphviz finds shorter ways, in minutes for some hundred boxes.
class BoxLayers {
 public:
  /// A box with so many rows of text; boxes are numbered from 0.
  void add_box(size_t rows) { rows_.push_back(rows); }
  void add_link(size_t from, size_t to) { links_.push_back({from, to}); }

  /// The middle of a box, in points, y upwards.
  struct BoxPosition {
    int x, y;
  };
  /// Of each box. Links must form no circle.
  std::vector<BoxPosition> places() const;

 private:
  struct Link {
    size_t from, to;
  };
  std::vector<size_t> rows_;
  std::vector<Link> links_;
};

}  // namespace isoshade::driver
