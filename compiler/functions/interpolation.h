// SPDX-License-Identifier: Apache-2.0
// Edge functions, depth and attribute interpolation of a snapped triangle, shared by rasterisers, stages and host.
//
// Positions are integers in 1/256 pixel, y down, |x|, |y| <= 2^21; the winding makes the doubled area positive. The
// edge function opposite vertex i is an exact integer, rounded once to float: the screen-space barycentric coordinate
// of vertex i, times the doubled area.
#pragma once

#include "compiler/functions/body.h"

namespace isoshade::functions {

/// (x1-x0)*(py-y0) - (y1-y0)*(px-x0) for differences below 2^15: exact in 32 bits, rounded once.
template <class F, class X, class P>
F edge_narrow(X x0, X y0, X x1, X y1, P px, P py) {
  return F(to_float((x1 - x0) * (py - y0) - (y1 - y0) * (px - x0)));
}

/// The same for differences below 2^23, in 64 bits: high * 2^23 + low, both exact as floats.
template <class F, class X, class P>
F edge_wide(X x0, X y0, X x1, X y1, P px, P py) {
  using I = int_of<F>;
  const I dx = x1 - x0;
  const I dy = y1 - y0;
  const I across = px - x0;
  const I down = py - y0;
  const I first_low = dx * down;
  const I second_low = dy * across;
  const I low = first_low - second_low;
  const I borrow = select(unsigned_less(first_low, second_low), I(1), I(0));
  const I high = mul_hi(dx, down) - mul_hi(dy, across) - borrow;
  const I upper = shift_left(high, 9) | shift_right(low, 23);
  const I lower = low & 0x7fffff;
  return to_float(upper) * F(8388608.0f) + to_float(lower);
}

/// The three edge functions at a pixel centre (px, py), in 1/256 pixel. `wide`: an edge spans 2^15 or more.
/// `wide_edge`: edge_wide, or a function that calls it.
template <class F, class X, class P, class WideEdge>
vec<F, 3> edge_functions(X x0, X y0, X x1, X y1, X x2, X y2, bool_of<F> wide, P px, P py, WideEdge wide_edge) {
  return branch(
      wide,
      [=] {
        return vec<F, 3>(wide_edge(x1, y1, x2, y2, px, py), wide_edge(x2, y2, x0, y0, px, py),
                         wide_edge(x0, y0, x1, y1, px, py));
      },
      [=] {
        return vec<F, 3>(edge_narrow<F>(x1, y1, x2, y2, px, py), edge_narrow<F>(x2, y2, x0, y0, px, py),
                         edge_narrow<F>(x0, y0, x1, y1, px, py));
      });
}

template <class F, class X, class P>
vec<F, 3> edge_functions(X x0, X y0, X x1, X y1, X x2, X y2, bool_of<F> wide, P px, P py) {
  return edge_functions<F>(x0, y0, x1, y1, x2, y2, wide, px, py, edge_wide<F, X, P>);
}

/// Interpolates depth linearly in screen space and clamps it to [0, 1].
template <class F>
F interpolate_depth(vec<F, 3> edges, F z0, F z1, F z2) {
  const F sum = (edges[0] + edges[1]) + edges[2];
  const F z = ((edges[0] * z0 + edges[1] * z1) + edges[2] * z2) / sum;
  const F above = select(z > F(0.0f), z, F(0.0f));
  return select(above < F(1.0f), above, F(1.0f));
}

/// Perspective-correct interpolation weights: attribute = (w0*a0 + w1*a1) + w2*a2. They sum to 1 up to rounding.
template <class F>
vec<F, 3> attribute_weights(vec<F, 3> edges, F inverse_w0, F inverse_w1, F inverse_w2) {
  const F l0 = edges[0] * inverse_w0;
  const F l1 = edges[1] * inverse_w1;
  const F l2 = edges[2] * inverse_w2;
  const F scale = F(1.0f) / ((l0 + l1) + l2);
  return vec<F, 3>(l0 * scale, l1 * scale, l2 * scale);
}

/// Interpolates an attribute of the three vertices.
template <class F, class A>
F interpolate(vec<F, 3> weights, A a0, A a1, A a2) {
  return (weights[0] * a0 + weights[1] * a1) + weights[2] * a2;
}
template <class F, int N>
vec<F, N> interpolate(vec<F, 3> weights, vec<F, N> a0, vec<F, N> a1, vec<F, N> a2) {
  return (splat<N>(weights[0]) * a0 + splat<N>(weights[1]) * a1) + splat<N>(weights[2]) * a2;
}

}  // namespace isoshade::functions
