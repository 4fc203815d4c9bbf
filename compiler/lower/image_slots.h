// SPDX-License-Identifier: Apache-2.0
// The images that a document reads: by its own nodes, and by those of the functions that it calls.
#pragma once

#include <string>
#include <unordered_map>
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
  /// Of the parameter or input, or of the node: for a call "node_slot". No other slot and no other parameter has it.
  std::string name;
  std::string parameter;  ///< that gives the path, or of a function the input; empty: a document gives it
  std::string path;       ///< what the document at `place` gives, relative to it; empty: no image
  support::Span place;    ///< where it does
  Decoding decoding = Decoding::linear;
  bool mips = false;  ///< levels of half the size are read too
  bool layers = false;  ///< other layers than the first are read too
  std::vector<Sampling> samplings;  ///< the ways in which nodes read it, each once
};

struct ImageSlots {
  std::vector<ImageSlot> slots;
  /// By node of TypedGraph::nodes that reads images: the one slot of an image, or that of each slot of the function
  /// that is called.
  std::unordered_map<uint32_t, std::vector<uint32_t>> of_node;
};

/// The slots of documents, those of each function made once.
class ImageSlotTable {
 public:
  /// Over all passes of an effect, in the order of its nodes. What no output depends on has none.
  const ImageSlots& of(const check::TypedGraph& graph);

 private:
  std::unordered_map<const check::TypedGraph*, ImageSlots> made_;
};

/// The slots of one document.
ImageSlots image_slots(const check::TypedGraph& graph);

/// Of a node whose row is an image.
Sampling sampling_of(const check::TypedGraph& graph, const check::Node& node);

}  // namespace isoshade::lower
