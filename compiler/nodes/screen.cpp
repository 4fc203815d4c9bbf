// SPDX-License-Identifier: Apache-2.0
// The inputs of full-screen effects. Only in post documents; the picture also in effects that are blended with it.
#include "compiler/nodes/table.h"

namespace isoshade::nodes {
namespace {

/// The taps must form a range, of limited length so that kernels stay fast.
std::optional<Refusal> range_exists(std::span<const Type>, std::span<const uint32_t> settings, Type) {
  const int64_t first = static_cast<int32_t>(settings[1]), last = static_cast<int32_t>(settings[2]);
  if (last < first)
    return Refusal{support::Id::out_of_range, 2, "\"last\" of \"sum_taps\" is less than \"first\""};
  if (last - first < max_taps) return std::nullopt;
  return Refusal{support::Id::out_of_range, 2,
                 "\"sum_taps\" has " + std::to_string(last - first + 1) + " taps, more than " +
                     std::to_string(max_taps)};
}

}  // namespace

std::vector<Row> screen_rows() {
  const Port offset_x{"offsetx", Integer, "the offset to the right, in pixels of the image", 0.0f};
  const Port offset_y{"offsety", Integer, "the offset downwards, in pixels of the image", 0.0f};
  const Port edge{"edge", Choice, "the value outside of the image: its border pixel, the mirrored image, or 0",
                  "clamp", edge_names};
  const Port shift{"shift", Vector2,
                   "a further offset: to the right as a share of the width of the image, and downwards of its height",
                   0.0f};
  return {
      {"scenecolor",
       "The linear colour of an image at the pixel, plus an offset. An image of another size is sampled at the position "
       "of the pixel's centre. In an effect, where only the `color` of a pass that is blended may use it: the colour of "
       "what is opaque, drawn with one sample a pixel.",
       {{"image", ImageName, "one of the document's \"images\"; default: the image that the post processes", ""},
        offset_x,
        offset_y,
        edge,
        {"filter",
         Choice,
         "the nearest pixel, or bilinear interpolation of four",
         "nearest",
         {"nearest", "linear"}},
        {"nonfinite",
         Choice,
         "keep infinite and NaN channels, or replace them by 0 before filtering",
         "keep",
         {"keep", "zero"}},
        shift},
       Color4,
       Fetch::color},
      {"scenedepth",
       "The depth of the scene. `out` is the stored depth: 1 at the near plane, 0 in the background. `linear` is the "
       "distance along the view direction in world units, at most 1e9; in the background it is 1e9, or the camera's "
       "\"far\" for an orthographic camera. `issky`: whether the pixel shows the background. In an effect "
       "it is the depth of what is opaque, and the rules of `scenecolor` hold.",
       {offset_x, offset_y, edge, shift},
       {{"out", Float}, {"linear", Float}, {"issky", Boolean}},
       Fetch::depth},
      {"motion",
       "How far what the pixel shows has moved since the frame before, in pixels: x to the right, y down, at most 16384 each "
       "way. Where the scene draws nothing, it is how the backdrop moves as the camera turns (0 for an orthographic camera); "
       "of what was behind the camera it is 0. Drawn with one sample a pixel; what is blended counts only where it writes "
       "depth.",
       {offset_x, offset_y, edge, shift},
       Vector2,
       Fetch::motion},
      {"worldposition",
       "The position of the surface that the pixel shows. To subtract another point without cancellation far from the "
       "origin, use the space \"camera\" and subtract the point from `cameraposition`.",
       {{"space",
         Choice,
         "relative to the origin or to the camera's position, along the world axes",
         "world",
         {"world", "camera"}}},
       Vector3,
       WorldPosition{}},
      {"viewray",
       "The vector from the camera through the pixel's centre, in world space, scaled so that its component along the "
       "view direction is 1.",
       {},
       Vector3,
       Screen::view_ray},
      {"cameraposition", "The position of the camera, in world space.", {}, Vector3, Screen::camera_position},
      {"cameradirection",
       "The unit view direction of the camera, in world space.",
       {},
       Vector3,
       Screen::camera_direction},
      {"pixelcoord", "The centre of the pixel, in pixels from the upper left corner.", {}, Vector2, Screen::pixel},
      {"screencoord",
       "The centre of the pixel, from 0 to 1: u to the right and v down.",
       {},
       Vector2,
       Screen::coordinate},
      {"screensize", "The width and height of the output image, in pixels.", {}, Vector2, Screen::size},
      {"tapindex", "The index of the tap. Only under sum_taps.", {}, Integer, TapIndex{}},
      {"sum_taps",
       "The sum of `in` over the taps from `first` to `last`, in order, starting from 0.",
       {{"in", AnyFloat, "the contribution of one tap"},
        {"first", SignedNumber, "the index of the first tap", 0.0f},
        {"last", SignedNumber, "the index of the last tap; at most 64 taps"}},
       AnyFloat,
       SumTaps{},
       range_exists},
  };
}

}  // namespace isoshade::nodes
