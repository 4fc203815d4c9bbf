// SPDX-License-Identifier: Apache-2.0
// Distances to random points, one in each cell. Worley, "A cellular texture basis function", 1996; points as in
// Open Shading Language and MaterialX.
#pragma once

#include <tuple>

#include "compiler/functions/cell.h"
#include "compiler/functions/comparison.h"

namespace isoshade::functions {

/// nearer(square of the distance, nearest...) for the points of the cell of p and of its eight neighbours.
template <class F, class Nearer, class... Nearest>
std::tuple<Nearest...> visit_feature_points(vec<F, 2> p, F jitter, Nearer nearer, Nearest... nearest) {
  using Int = int_of<F>;
  const InCell<F> x = split_cell(p[0]);
  const InCell<F> y = split_cell(p[1]);
  // From p to the point, along one axis.
  const auto offset = [&](Int i, F place, Int hash) {
    const F in_cell = (unit_of_bits(hash) - 0.5f) * jitter + 0.5f;
    return (to_float(i - 1) + in_cell) - place;
  };
  const auto column = [&](Int i, Int cell_x, Nearest... before) {
    const auto cell = [&](Int j, Int cell_y, Nearest... so_far) {
      const F dx = offset(i, x.place, hash_channel(cell_x, cell_y, 0));
      const F dy = offset(j, y.place, hash_channel(cell_x, cell_y, 1));
      return std::tuple_cat(std::tuple(cell_y + 1), nearer(dx * dx + dy * dy, so_far...));
    };
    const auto visit = [&](Int, Nearest... found) { return std::tuple(cell_x + 1, found...); };
    return std::apply(visit, loop(Int(3), cell, y.cell - 1, before...));
  };
  const auto drop_cell = [](Int, Nearest... found) { return std::tuple(found...); };
  return std::apply(drop_cell, loop(Int(3), column, x.cell - 1, nearest...));
}

/// The distance to the nearest of random points in the plane, one in each unit square: anywhere in it for a jitter
/// of 1, in its middle for 0.
/// Domain: all floats; coordinates from 2^31 on in magnitude, infinities and NaN count as 0. Only the point's square
/// and its neighbours are searched, which a jitter outside [0, 1] leads out of. A NaN jitter gives +inf.
/// Error: 2 ULP of 1, for a jitter in [0, 1].
template <class F>
F worleynoise2d(vec<F, 2> p, F jitter) {
  const auto nearer = [](F square, F nearest) { return std::tuple(min(nearest, square)); };
  return sqrt(std::get<0>(visit_feature_points(p, jitter, nearer, F(infinity))));
}

/// The distances to the nearest, second and third of the points of worleynoise2d.
/// Domain: all floats; coordinates from 2^31 on in magnitude, infinities and NaN count as 0. Only the point's square
/// and its neighbours are searched, which a jitter outside [0, 1] leads out of. A NaN jitter gives +inf.
/// Error: 2 ULP of 1, for a jitter in [0, 1], in each component.
template <class F>
vec<F, 3> worleynoise2d_vector3(vec<F, 2> p, F jitter) {
  const auto nearer = [](F square, F first, F second, F third) {
    const F not_first = max(first, square);
    const F not_second = max(second, not_first);
    return std::tuple(min(first, square), min(second, not_first), min(third, not_second));
  };
  const auto squares = visit_feature_points(p, jitter, nearer, F(infinity), F(infinity), F(infinity));
  return {sqrt(std::get<0>(squares)), sqrt(std::get<1>(squares)), sqrt(std::get<2>(squares))};
}

}  // namespace isoshade::functions
