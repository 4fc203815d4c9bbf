// SPDX-License-Identifier: Apache-2.0
// The screen: what full-screen effects read. Only in post documents.
#include "compiler/nodes/table.h"

namespace isoshade::nodes {
namespace {

/// Loops of a kernel stay short.
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
  const Port offset_x{"offsetx", Integer, "pixels of the image to the right", 0.0f};
  const Port offset_y{"offsety", Integer, "pixels of the image downwards", 0.0f};
  const Port edge{"edge", Choice, "what is read beyond the image: its last pixel, the image mirrored, or 0",
                  "clamp", edge_names};
  return {
      {"scenecolor",
       "The image, linear, at the pixel or beside it. Of an image of another size, what lies under the "
       "pixel's centre.",
       {{"image", ImageName, "one of the document's \"images\"; without it the image that the post goes over",
         ""},
        offset_x,
        offset_y,
        edge,
        {"filter",
         Choice,
         "the pixel that the centre lies in, or the four around it in proportion",
         "nearest",
         {"nearest", "linear"}},
        {"nonfinite",
         Choice,
         "what a channel that is infinite or NaN counts as, before it is filtered: itself, or 0",
         "keep",
         {"keep", "zero"}}},
       Color4,
       Fetch::color},
      {"scenedepth",
       "The depth of the scene. `out` is as it is stored: 1 at the near plane, 0 where there is nothing. "
       "`linear` is "
       "the distance along the view, in world units: at most 1e9, which it is where there is nothing; under "
       "orthographic projection it is the camera's \"far\" there. `issky`: whether there is nothing.",
       {offset_x, offset_y, edge},
       {{"out", Float}, {"linear", Float}, {"issky", Boolean}},
       Fetch::depth},
      {"worldposition",
       "The point that the pixel shows. What is subtracted from it is better subtracted from "
       "`cameraposition`, and "
       "the point taken in the space \"camera\": far from the origin nothing is lost then.",
       {{"space",
         Choice,
         "from the origin, or from the camera's position, along the axes of the world",
         "world",
         {"world", "camera"}}},
       Vector3,
       WorldPosition{}},
      {"viewray",
       "Vector from the camera through the pixel's centre, in world space, scaled to advance one unit along the view "
       "direction.",
       {},
       Vector3,
       Screen::view_ray},
      {"cameraposition", "Where the camera stands, in world space.", {}, Vector3, Screen::camera_position},
      {"cameradirection",
       "The unit vector that the camera looks along, in world space.",
       {},
       Vector3,
       Screen::camera_direction},
      {"pixelcoord", "The centre of the pixel, in pixels from the upper left.", {}, Vector2, Screen::pixel},
      {"screencoord",
       "The centre of the pixel, from 0 to 1: u to the right and v down.",
       {},
       Vector2,
       Screen::coordinate},
      {"screensize", "Width and height of the image that is made, in pixels.", {}, Vector2, Screen::size},
      {"tapindex", "The number of the tap. Only under sum_taps.", {}, Integer, TapIndex{}},
      {"sum_taps",
       "The sum of `in` over the taps from `first` to `last`, from 0, in their order.",
       {{"in", AnyFloat, "what one tap adds"},
        {"first", SignedNumber, "the number of the first tap", 0.0f},
        {"last", SignedNumber, "the number of the last tap; there are at most 64"}},
       AnyFloat,
       SumTaps{},
       range_exists},
  };
}

}  // namespace isoshade::nodes
