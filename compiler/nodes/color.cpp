// SPDX-License-Identifier: Apache-2.0
// Adjusting colours. Alpha stays what it is.
#include "compiler/nodes/site.h"
#include "compiler/nodes/table.h"

namespace isoshade::nodes {
namespace {

/// The first three components, and back with the fourth of `in` if it has one.
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
       "How bright `in` is, as a grey.",
       {{"in", Color, "a linear colour"},
        {"lumacoeffs", Color3, "the weights of red, green and blue; left out, those of Rec. 709 and sRGB",
         rec709}},
       Color,
       luminance},
      {"contrast",
       "(`in` - `pivot`) * `amount` + `pivot`.",
       {{"in", AnyFloat, "the value"},
        {"amount", AnyFloat, "above 1 away from `pivot`, below 1 towards it", 1.0f},
        {"pivot", AnyFloat, "the value that stays", 0.5f}},
       AnyFloat,
       Function{"contrast"}},
      {"rgbtohsv",
       "Red, green and blue as hue, saturation and value; a hue of 1 is the whole circle.",
       {{"in", Color, "red, green, blue"}},
       Color,
       convert_rgb<to_hsv>},
      {"hsvtorgb",
       "Hue, saturation and value as red, green and blue.",
       {{"in", Color, "hue, of which 1 is the whole circle, saturation, value"}},
       Color,
       convert_rgb<to_rgb>},
  };
}

}  // namespace isoshade::nodes
