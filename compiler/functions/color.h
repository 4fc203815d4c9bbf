// SPDX-License-Identifier: Apache-2.0
// Colour. The sRGB transfer function (IEC 61966-2-1) uses polynomials in the distance from the middle or the lower end
// of a piece, which keeps rounding errors small; both directions are monotonic over all floats.
#pragma once

#include "compiler/functions/comparison.h"
#include "compiler/functions/rounding.h"

namespace isoshade::functions {

/// Evaluates one of two polynomials by Horner's rule.
template <class F, class Condition, size_t n>
F polynomial_of_two(F x, Condition first, const float (&a)[n], const float (&b)[n]) {
  F p = select(first, F(a[0]), F(b[0]));
  for (size_t i = 1; i < n; ++i) p = p * x + select(first, F(a[i]), F(b[i]));
  return p;
}

/// Linear light to sRGB.
/// Domain: all floats; negative values and NaN give 0, values above 1 give 1. Exact at 0 and 1.
/// Error: 4 ULP. The standard's curve falls by 8 ULP where its pieces meet (0.0031308); here both pieces are clamped to
/// the middle of the gap.
/// Source: polynomials in the fourth root of 8x, the most accurate choice in float, by Sollya's fpminimax.
template <class F>
F srgb_encode(F x) {
  constexpr float joint = 0x1.4b5da4p-5f;
  constexpr float piece_0 = 0x1.973dfp-2f;
  constexpr float piece_1 = 0x1.999b42p-1f;
  const F root = sqrt(sqrt(x * 8.0f));
  const auto in_0 = root < piece_1;
  const F curve = polynomial_of_two(root - select(in_0, F(piece_0), F(piece_1)), in_0,
                                    {-0x1.e33ec6p-6f, 0x1.0c155cp-4f, -0x1.3bc23ep-4f, 0x1.38c10ep-4f,
                                     -0x1.7ed002p-4f, 0x1.57230cp-2f, 0x1.9966ap-2f, 0x1.4af6dcp-5f},
                                    {-0x1.39117p-11f, 0x1.78cf14p-9f, -0x1.d87be2p-8f, 0x1.e523f6p-7f,
                                     -0x1.2d3864p-5f, 0x1.0fd1acp-2f, 0x1.4632c6p-1f, 0x1.00d5d2p-2f});
  const F within = select(x <= 0.0031308f, min(x * 12.92f, F(joint)), max(curve, F(joint)));
  const F below_one = select(x < 1.0f, within, F(1.0f));
  return select(x > 0.0f, below_one, F(0.0f));
}

/// sRGB to linear light.
/// Domain: all floats; negative values and NaN give 0, values above 1 give 1. Exact at 0 and 1.
/// Error: 3 ULP.
/// Source: polynomials by Sollya's fpminimax.
template <class F>
F srgb_decode(F x) {
  constexpr float middle_0 = 0x1.552p-4f;
  constexpr float middle_1 = 0x1.5784p-2f;
  const auto in_0 = x < 0.28f;
  const F curve =
      polynomial_of_two(x - select(in_0, F(middle_0), F(middle_1)), in_0,
                        {-0x1.954e9cp3f, 0x1.5d1cbp3f, -0x1.2b9088p2f, 0x1.a29088p0f, -0x1.678d6cp-1f,
                         0x1.4a90fp-1f, 0x1.56d50ap-1f, 0x1.0ee67p-3f, 0x1.f37ap-8f},
                        {-0x1.143d12p-6f, 0x1.c0739ep-5f, -0x1.62c18p-4f, 0x1.a3b8a2p-4f, -0x1.0f5bbep-3f,
                         0x1.62a65ap-2f, 0x1.03a45cp0f, 0x1.21a91ep-1f, 0x1.7901dcp-4f});
  const F within = select(x <= 0.04045f, x * 0x1.3d0722p-4f, curve);
  const F below_one = select(x < 1.0f, within, F(1.0f));
  return select(x > 0.0f, below_one, F(0.0f));
}

/// The luminance of a linear colour with the primaries of Rec. 709 and sRGB. For other primaries, use `dot`.
/// Domain: all floats; infinities of different signs and NaN give NaN. White gives exactly 1.
/// Error: 2 ULP of the sum of the terms' magnitudes.
template <class F>
F luminance(vec<F, 3> color) {
  return (color[0] * 0.2126f + color[1] * 0.7152f) + color[2] * 0.0722f;
}

/// HSV to RGB; a full turn of hue is 1.
/// Domain: all floats. The hue wraps; saturation and value are not clamped. An infinite or NaN hue gives
/// value * (1 - saturation) in all components.
/// Error: 5 ULP of |value|, for a saturation in [0, 1].
/// Source: Smith, "Color gamut transform pairs", 1978, as three ramps of the hue.
template <class F>
vec<F, 3> hsv_to_rgb(vec<F, 3> hsv) {
  const F sixths = fract(hsv[0]) * 6.0f;
  const F red = saturate(abs(sixths - 3.0f) - 1.0f);
  const F green = saturate(2.0f - abs(sixths - 2.0f));
  const F blue = saturate(2.0f - abs(sixths - 4.0f));
  const auto mixed = [&](F hue) { return (1.0f - hsv[1] * (1.0f - hue)) * hsv[2]; };
  return {mixed(red), mixed(green), mixed(blue)};
}

/// RGB to HSV; the hue is in [0, 1], and a full turn is 1.
/// Domain: all floats. Greys, and colours without a positive component, have hue and saturation 0. Hue and saturation
/// may be infinite or NaN if a component is, or if a difference of components overflows.
/// Error: 3 ULP.
/// Source: Smith, "Color gamut transform pairs", 1978.
template <class F>
vec<F, 3> rgb_to_hsv(vec<F, 3> rgb) {
  const F red = rgb[0];
  const F green = rgb[1];
  const F blue = rgb[2];
  const F value = max(max(red, green), blue);
  const F chroma = value - min(min(red, green), blue);
  const auto colourful = (chroma > 0.0f) & (value > 0.0f);
  const auto reddest = red >= value;
  const auto greenest = green >= value;
  const F difference = select(reddest, green - blue, select(greenest, blue - red, red - green));
  const F start = select(reddest, F(0.0f), select(greenest, F(2.0f), F(4.0f)));
  const F sixths = start + difference / select(colourful, chroma, F(1.0f));
  const F hue = select(sixths < 0.0f, sixths + 6.0f, sixths) * 0.166666672f;
  const F saturation = chroma / select(colourful, value, F(1.0f));
  return {select(colourful, hue, F(0.0f)), select(colourful, saturation, F(0.0f)), value};
}

}  // namespace isoshade::functions
