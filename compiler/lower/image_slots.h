// SPDX-License-Identifier: Apache-2.0
// The images that an effect reads.
#pragma once

#include <string>
#include <vector>

#include "compiler/check/typed_graph.h"
#include "compiler/lower/sampling.h"
#include "compiler/nodes/row.h"

namespace isoshade::lower {

/// How the numbers of a file become linear.
enum class Decoding : uint8_t {
  linear,        ///< they are
  srgb,          ///< by srgb_decode, but for the fourth
  srgb_if_bytes  ///< the same, if they have 8 bits
};

/// A file that nodes read in one way. Each object has a word for it in its record (frame_layout.h).
struct ImageSlot {
  std::string name;       ///< of the parameter or the node; no other slot is called so, nor another parameter
  std::string parameter;  ///< that has the path; empty: the path is the document's
  std::string path;       ///< what the document says; relative to it; empty: none
  graph::TextRange place;     ///< where it says so
  Decoding decoding = Decoding::linear;
  bool mips = false;  ///< levels of half the size are read too
  std::vector<Sampling> samplings;  ///< the ways in which nodes read it, each once
};

struct ImageSlots {
  std::vector<ImageSlot> slots;
  std::vector<uint32_t> of_node;  ///< by TypedGraph::nodes: the slot of what is an image
};

/// The slots of an effect, over all of its passes, in the order of its nodes. What no pass reads has none.
ImageSlots image_slots(const check::TypedGraph& graph);

/// Of a node whose row is an image.
Sampling sampling_of(const check::TypedGraph& graph, const check::Node& node);

}  // namespace isoshade::lower
