// SPDX-License-Identifier: Apache-2.0
// What a post document reads: images, the depth, the camera; as parameters of `post_process`, and as reads.
#pragma once

#include <array>
#include <vector>

#include "compiler/check/typed_graph.h"
#include "compiler/interface/binding.h"
#include "compiler/ir/builder.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/nodes/row.h"
#include "compiler/nodes/site.h"

namespace isoshade::lower {

struct Needs;

/// Of an image, what some nodes need.
struct ImageNeeds {
  bool read = false;
  bool size = false;    ///< reads may lead beyond it
  bool inside = false;  ///< reads are filtered
};

/// Of the screen, what some nodes need.
struct ScreenNeeds {
  std::array<bool, interface::screen_value_count> values{};  ///< by Screen
  std::vector<ImageNeeds> images;                            ///< by ImageNumber
  std::vector<uint32_t> sums;                                ///< nodes that sum over taps, as they are written

  /// What a node needs, and one that something reads.
  void add(const check::TypedGraph& graph, uint32_t node);
  void add(const check::TypedGraph& graph, const check::Operand& operand);
};

/// An image that can be read: the pixel of it that lies under the centre of the pixel that is made, where in that
/// pixel (vec2, 0 to 1), its size, and the function that reads it at a pixel that it has. What is not needed is none.
struct ReadImage {
  ir::ValueId x = ir::none, y = ir::none, inside = ir::none, width = ir::none, height = ir::none;
  uint32_t at = ir::none;
};

/// The parameters of `post_process` that describe the screen.
struct ScreenInputs {
  std::array<ir::ValueId, interface::screen_value_count> values{};
  std::vector<ReadImage> images;                             ///< by ImageNumber
  std::vector<std::pair<uint32_t, ir::ValueId>> tap_counts;  ///< of each sum over taps

  ir::ValueId operator[](interface::Screen value) const { return values[static_cast<size_t>(value)]; }
};

/// The images that a post reads: the scene's depth; the image that the post goes over; those of Graph::images.
inline constexpr interface::ImageNumber depth_image = image_record::depth;
/// 0: the image that the post goes over; then those of Graph::images.
constexpr interface::ImageNumber post_image(size_t number) {
  return static_cast<interface::ImageNumber>(image_record::color + number);
}

/// The image that the node `motion` reads.
interface::ImageNumber motion_image(const check::TypedGraph& graph);

/// Declares the functions that read images, without bodies; `host` receives them.
void declare_reads(ir::Module& module, interface::Interface& host, const check::TypedGraph& graph,
                   const ScreenNeeds& needs);
/// The parameters that `needs` asks for, but for tap counts, which come last.
std::vector<interface::Binding> screen_bindings(const check::TypedGraph& graph, const ScreenNeeds& needs);
std::vector<interface::Binding> tap_bindings(const check::TypedGraph& graph, const ScreenNeeds& needs);

/// The nodes that sum over taps, as they are written, and how many taps each has.
struct TapSum {
  uint32_t node;  ///< in Graph::nodes
  int taps;
};
std::vector<TapSum> tap_sums(const check::TypedGraph& graph);

/// How nodes::Fetch::color reads an image.
struct ColorFilter {
  nodes::Edge edge;
  bool linear;       ///< the four pixels around the place in proportion; else the one that it lies in
  bool finite_only;  ///< channels that are infinite or NaN count as 0
};

/// How far from the pixel an image is read. What is none is 0.
struct FetchOffset {
  ir::ValueId x = ir::none, y = ir::none;  ///< in pixels of the image
  ir::ValueId shift = ir::none;            ///< vec2, further, in widths and heights of the image
};

/// What nodes::Fetch::color, ::motion and ::depth and nodes::WorldPosition give.
nodes::Value fetch_color(ir::Builder& b, const ReadImage& image, const FetchOffset& offset, const ColorFilter& filter);
/// The depth as it is stored.
ir::ValueId fetch_depth(ir::Builder& b, const ReadImage& depth, const FetchOffset& offset, nodes::Edge edge);
/// The distance along the view of a depth.
ir::ValueId distance_of(ir::Builder& b, const ScreenInputs& screen, ir::ValueId depth);
/// The point that the pixel shows, from the camera's position.
ir::ValueId relative_position(ir::Builder& b, const ScreenInputs& screen);

}  // namespace isoshade::lower
