// SPDX-License-Identifier: Apache-2.0
// Textures. Only in effects: a function takes what it needs as inputs.
#include "compiler/nodes/table.h"

namespace isoshade::nodes {

std::vector<Row> texture_rows() {
  const std::vector<std::string_view> modes{"periodic", "clamp", "mirror", "constant"};
  return {
      {"image",
       "The picture in a file at `texcoord`, of which (0, 0) is the upper left corner and (1, 1) the lower "
       "right. "
       "Numbers that it lacks are those of black or, for the fourth, of 1; a grey picture has three alike.",
       {{"file", Filename,
         "a path, relative to the document, or {\"link\": \"...\"} to a parameter; \"\" is no picture"},
        {"default", AnyFloat, "what it gives where there is no picture", 0.0f},
        {"texcoord", Vector2, "where it is asked for", SurfaceValue{Surface::texcoord}},
        {"uaddressmode", Choice, "what lies to the left and right of it; constant: `default`", "periodic",
         modes},
        {"vaddressmode", Choice, "what lies above and below", "periodic", modes},
        {"filtertype",
         Choice,
         "the nearest texel; in proportion between the nearest four; also between two sizes of the picture, "
         "by how "
         "much of it a pixel covers",
         "linear",
         {"closest", "linear", "trilinear"}},
        {"colorspace",
         Choice,
         "of the file; auto: sRGB where it has 8 bits and is read as a colour, else linear",
         "auto",
         {"auto", "srgb", "linear"}},
        {"to", name_of(AnyFloat), "the type of the result", "color3"}},
       AnyFloat,
       Image{}},
  };
}

}  // namespace isoshade::nodes
