// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/box_layers.h"

#include <algorithm>

namespace isoshade::driver {

namespace {

constexpr int column_width = 220, row_height = 17, gap = 14;

}  // namespace

std::vector<BoxLayers::BoxPosition> BoxLayers::positions() const {
  const size_t count = rows_.size();
  std::vector<std::vector<size_t>> followers(count);
  std::vector<size_t> awaited(count), column(count);
  for (const Link& link : links_) {
    followers[link.from].push_back(link.to);
    ++awaited[link.to];
  }
  // The boxes in topological order; `ready` grows during the traversal.
  std::vector<size_t> ready;
  for (size_t box = 0; box < count; ++box)
    if (awaited[box] == 0) ready.push_back(box);
  for (size_t i = 0; i < ready.size(); ++i)
    for (const size_t next : followers[ready[i]]) {
      column[next] = std::max(column[next], column[ready[i]] + 1);
      if (--awaited[next] == 0) ready.push_back(next);
    }

  std::vector<std::vector<size_t>> columns;
  for (const size_t box : ready) {
    if (column[box] >= columns.size()) columns.resize(column[box] + 1);
    columns[column[box]].push_back(box);
  }
  // Align each box with the mean of the boxes that it reads, as far as the boxes above it in its column leave room.
  std::vector<BoxPosition> positions(count, BoxPosition{0, 0});
  std::vector<double> sum(count), wanted(count);
  std::vector<size_t> read(count);
  for (size_t c = 0; c < columns.size(); ++c) {
    std::vector<size_t>& boxes = columns[c];
    for (const size_t box : boxes)
      wanted[box] = read[box] == 0 ? 0 : sum[box] / static_cast<double>(read[box]);
    std::ranges::stable_sort(boxes, [&](size_t a, size_t b) { return wanted[a] < wanted[b]; });
    int below = 0;
    for (const size_t box : boxes) {
      const int height = static_cast<int>(rows_[box]) * row_height;
      const int y = std::max(below, static_cast<int>(wanted[box]) - height / 2) + height / 2;
      below = y + height / 2 + gap;
      positions[box] = {static_cast<int>(c) * column_width, -y};
      for (const size_t next : followers[box]) {
        sum[next] += y;
        ++read[next];
      }
    }
  }
  return positions;
}

}  // namespace isoshade::driver
