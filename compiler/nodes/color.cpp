// SPDX-License-Identifier: Apache-2.0
// Colour adjustments. They keep alpha unchanged.
#include "compiler/nodes/site.h"
#include "compiler/nodes/table.h"

namespace isoshade::nodes {
namespace {

/// The first three components of `in`; with_alpha() appends the fourth, if `in` has one.
ir::ValueId rgb_of(Site& s) {
  return s.b.construct(std::array{s.b.extract(s[0], 0), s.b.extract(s[0], 1), s.b.extract(s[0], 2)});
}

ir::ValueId with_alpha(Site& s, std::array<ir::ValueId, 3> rgb) {
  if (s.types[0] == Type::color3) return s.b.construct(rgb);
  return s.b.construct(std::array{rgb[0], rgb[1], rgb[2], s.b.extract(s[0], 3)});
}

void luminance(Site& s) {
  const ir::ValueId value = s.call("dot", {rgb_of(s), s.in[1]}).id();
  s.out[0] = with_alpha(s, {value, value, value});
}

template <const char* function>
void convert_rgb(Site& s) {
  const ir::ValueId converted = s.call(function, {Value(rgb_of(s))}).id();
  s.out[0] = with_alpha(s, {s.b.extract(converted, 0), s.b.extract(converted, 1), s.b.extract(converted, 2)});
}

constexpr char to_hsv[] = "rgb_to_hsv";
constexpr char to_rgb[] = "hsv_to_rgb";

}  // namespace

std::vector<Row> color_rows() {
  constexpr std::array rec709{0.2126f, 0.7152f, 0.0722f};
  return {
      {"luminance",
       "The luminance of `in`, as a grey colour.",
       {{"in", Color, "a linear colour"},
        {"lumacoeffs", Color3, "the weights of red, green and blue; default: those of Rec. 709 and sRGB",
         rec709}},
       Color,
       luminance},
      {"contrast",
       "(`in` - `pivot`) * `amount` + `pivot`.",
       {{"in", AnyFloat, "the value"},
        {"amount", AnyFloat, "above 1: away from `pivot`; below 1: towards it", 1.0f},
        {"pivot", AnyFloat, "the value that does not change", 0.5f}},
       AnyFloat,
       Function{"contrast"}},
      {"rgbtohsv",
       "RGB to HSV (hue, saturation, value); a full turn of hue is 1.",
       {{"in", Color, "red, green, blue"}},
       Color,
       convert_rgb<to_hsv>},
      {"hsvtorgb",
       "HSV (hue, saturation, value) to RGB.",
       {{"in", Color, "hue (a full turn is 1), saturation, value"}},
       Color,
       convert_rgb<to_rgb>},
  };
}

}  // namespace isoshade::nodes
