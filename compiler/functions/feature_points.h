// SPDX-License-Identifier: Apache-2.0
// Cellular noise: distances to random points, one per cell. Worley, "A cellular texture basis function", 1996; the
// points are those of Open Shading Language and MaterialX.
#pragma once

#include <tuple>

#include "compiler/functions/cell.h"
#include "compiler/functions/comparison.h"

namespace isoshade::functions {

/// Folds nearest = nearer(squared distance, nearest...) over the points in the cell of p and its eight neighbours.
template <class F, class Nearer, class... Nearest>
std::tuple<Nearest...> visit_feature_points(vec<F, 2> p, F jitter, Nearer nearer, Nearest... nearest) {
  using Int = int_of<F>;
  const InCell<F> x = split_cell(p[0]);
  const InCell<F> y = split_cell(p[1]);
  // The distance from p to the point along one axis.
  const auto offset = [&](Int i, F fraction, Int hash) {
    const F in_cell = (unit_of_bits(hash) - 0.5f) * jitter + 0.5f;
    return (to_float(i - 1) + in_cell) - fraction;
  };
  const auto column = [&](Int i, Int cell_x, Nearest... before) {
    const auto cell = [&](Int j, Int cell_y, Nearest... so_far) {
      const F dx = offset(i, x.fraction, hash_channel(cell_x, cell_y, 0));
      const F dy = offset(j, y.fraction, hash_channel(cell_x, cell_y, 1));
      return std::tuple_cat(std::tuple(cell_y + 1), nearer(dx * dx + dy * dy, so_far...));
    };
    const auto visit = [&](Int, Nearest... found) { return std::tuple(cell_x + 1, found...); };
    return std::apply(visit, loop(Int(3), cell, y.cell - 1, before...));
  };
  const auto drop_cell = [](Int, Nearest... found) { return std::tuple(found...); };
  return std::apply(drop_cell, loop(Int(3), column, x.cell - 1, nearest...));
}

/// The distance to the nearest of random points in the plane, one per unit square: anywhere in the square for jitter
/// 1, at its centre for jitter 0.
/// Domain: all floats; coordinates of a magnitude from 2^31, infinities and NaN count as 0. Only the square of p and
/// its neighbours are searched; jitter outside [0, 1] moves points out of them. A NaN jitter gives +inf.
/// Error: 2 ULP of 1, for a jitter in [0, 1].
template <class F>
F worleynoise2d(vec<F, 2> p, F jitter) {
  const auto nearer = [](F square, F nearest) { return std::tuple(min(nearest, square)); };
  return sqrt(std::get<0>(visit_feature_points(p, jitter, nearer, F(infinity))));
}

/// The distances to the nearest, second and third nearest point of worleynoise2d.
/// Domain: all floats; coordinates of a magnitude from 2^31, infinities and NaN count as 0. Only the square of p and
/// its neighbours are searched; jitter outside [0, 1] moves points out of them. A NaN jitter gives +inf.
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
