// SPDX-License-Identifier: Apache-2.0
// Textures. Only in effects and in the functions that they call.
#include "compiler/nodes/table.h"

namespace isoshade::nodes {

std::vector<Row> texture_rows() {
  const std::vector<std::string_view> modes{"periodic", "clamp", "mirror", "constant"};
  return {
      {"image",
       "The texture in a file, sampled at `texcoord`; (0, 0) is the upper left corner and (1, 1) the lower right. "
       "Missing channels are 0, a missing fourth channel is 1; greyscale images have three equal channels.",
       {{"file", Filename,
         "a path, relative to the document, or {\"link\": \"...\"} to a parameter or an input; \"\" for no image"},
        {"default", AnyFloat, "the result without an image", 0.0f},
        {"texcoord", Vector2, "the texture coordinates", SurfaceValue{Surface::texcoord}},
        {"uaddressmode", Choice, "the addressing mode to the left and right; constant: `default`", "periodic", modes,
         true},
        {"vaddressmode", Choice, "the addressing mode above and below", "periodic", modes, true},
        {"filtertype",
         Choice,
         "closest: the nearest texel; linear: bilinear interpolation of four texels; trilinear: also interpolates "
         "between two mip levels, chosen by the size of the pixel in the texture",
         "linear",
         {"closest", "linear", "trilinear"},
         true},
        {"colorspace",
         Choice,
         "the colour space of the file; auto: sRGB if it has 8 bits per channel and is read as a colour, else linear",
         "auto",
         {"auto", "srgb", "linear"}},
        {"layer", Integer, "which layer of a file that has several; the nearest there is", 0.0f},
        {"to", name_of(AnyFloat), "the type of the result", "color3"}},
       AnyFloat,
       Image{}},
  };
}

}  // namespace isoshade::nodes
