// SPDX-License-Identifier: Apache-2.0
#include "compiler/lower/image_slots.h"

#include <algorithm>
#include <tuple>
#include <unordered_set>
#include <utility>

#include "compiler/graph/files.h"
#include "compiler/lower/body.h"
#include "compiler/lower/lower.h"

namespace isoshade::lower {
namespace {

using check::Operand;
namespace port = nodes::image_port;

Decoding decoding_of(const check::TypedGraph& graph, const check::Node& node) {
  switch (static_cast<nodes::ColorSpace>(graph.operands_of(node)[port::colorspace].index)) {
    case nodes::ColorSpace::srgb: return Decoding::srgb;
    case nodes::ColorSpace::linear: return Decoding::linear;
    case nodes::ColorSpace::automatic: break;
  }
  return nodes::color_types.has(graph.types_of(node)[0]) ? Decoding::srgb_if_bytes : Decoding::linear;
}

/// Sets where the path of a slot comes from: the operand of an image node or of a call.
void set_path(ImageSlot& slot, const check::TypedGraph& graph, const Operand& file) {
  if (file.from == Operand::From::input) {
    const graph::Input& input = graph.graph.inputs[file.index];
    slot.name = slot.parameter = input.name;
    slot.path = input.value ? input.value->string : "";
    slot.place = graph.graph.span(input.value ? input.value_place : input.place);
  } else {
    slot.path = graph.files[file.index].path;
    slot.place = graph.files[file.index].place;
  }
}

/// The slot of an image node alone.
ImageSlot slot_of_image(const check::TypedGraph& graph, uint32_t index) {
  const check::Node& node = graph.nodes[index];
  ImageSlot slot;
  slot.name = graph.graph.nodes[index].id;
  set_path(slot, graph, graph.operands_of(node)[port::file]);
  slot.decoding = decoding_of(graph, node);
  slot.samplings = {sampling_of(graph, node)};
  slot.mips = check::may_be_trilinear(graph, node);
  slot.layers = check::reads_layers(graph, node);
  return slot;
}

/// What a slot of a function is in the document that calls it.
ImageSlot slot_in_caller(ImageSlot slot, const check::TypedGraph& graph, uint32_t call) {
  const check::Node& node = graph.nodes[call];
  const std::string input = std::exchange(slot.parameter, "");
  slot.name = graph.graph.nodes[call].id + "_" + slot.name;
  const std::span<const Operand> operands = graph.operands_of(node);
  if (!input.empty()) set_path(slot, graph, operands[node.callee->graph.names.at(input).index]);
  // An input of the function that chooses a mode: what the call gives it, as far as that is known here.
  const auto translate = [&]<class Mode>(uint32_t& chosen_by, Mode& mode) {
    if (chosen_by == ir::none) return;
    const Operand& operand = operands[chosen_by];
    if (operand.from == Operand::From::words) mode = static_cast<Mode>(graph.words[operand.index]);
    chosen_by = operand.from == Operand::From::input ? operand.index : ir::none;
  };
  for (Sampling& sampling : slot.samplings) {
    translate(sampling.filter_input, sampling.filter);
    translate(sampling.u_input, sampling.u);
    translate(sampling.v_input, sampling.v);
  }
  return slot;
}

/// Whether both are read from one file in one way. A path means the same in all documents of a folder.
bool are_same(const ImageSlot& a, const ImageSlot& b) {
  const auto folder = [](const ImageSlot& slot) { return graph::path_beside(slot.place.file->path(), "."); };
  return std::tie(a.parameter, a.path, a.decoding) == std::tie(b.parameter, b.path, b.decoding) &&
         (!a.parameter.empty() || a.path.empty() || a.place.file == b.place.file || folder(a) == folder(b));
}

/// Adds slots to those of a document.
class SlotCollector {
 public:
  explicit SlotCollector(const check::TypedGraph& graph) {
    for (const std::vector<std::string>& names : parameter_names(graph))
      parameters_.insert(names.begin(), names.end());
    for (const graph::Input& input : graph.graph.inputs) parameters_.insert(input.name);
  }

  /// Returns the number of the slot that is the same.
  uint32_t add(ImageSlot slot) {
    std::vector<ImageSlot>& slots = made.slots;
    const auto found =
        std::ranges::find_if(slots, [&](const ImageSlot& other) { return are_same(slot, other); });
    const auto number = static_cast<uint32_t>(found - slots.begin());
    if (found == slots.end()) {
      // A parameter that is read in two ways has two slots; none has the name of a parameter or a column of one.
      const auto taken = [&] {
        return (slot.name != slot.parameter && parameters_.contains(slot.name)) ||
               std::ranges::find(slots, slot.name, &ImageSlot::name) != slots.end();
      };
      while (taken()) slot.name += "_";
      slots.push_back(std::move(slot));
      return number;
    }
    found->mips |= slot.mips;
    found->layers |= slot.layers;
    for (const Sampling& sampling : slot.samplings)
      if (std::ranges::find(found->samplings, sampling) == found->samplings.end())
        found->samplings.push_back(sampling);
    return number;
  }

  ImageSlots made;

 private:
  std::unordered_set<std::string> parameters_;
};

}  // namespace

Sampling sampling_of(const check::TypedGraph& graph, const check::Node& node) {
  // What a port says, or the default of the input that it is linked to.
  const auto choice = [&](size_t port) {
    const Operand& operand = graph.operands_of(node)[port];
    if (operand.from != Operand::From::input) return operand.index;
    const graph::Input& input = graph.graph.inputs[operand.index];
    return input.value ? static_cast<uint32_t>(input.value->integer) : 0;
  };
  const auto input = [&](size_t port) {
    const Operand& operand = graph.operands_of(node)[port];
    return operand.from == Operand::From::input ? operand.index : ir::none;
  };
  return {static_cast<nodes::Filter>(choice(port::filtertype)),
          static_cast<nodes::AddressMode>(choice(port::uaddressmode)),
          static_cast<nodes::AddressMode>(choice(port::vaddressmode)),
          input(port::filtertype),
          input(port::uaddressmode),
          input(port::vaddressmode)};
}

const ImageSlots& ImageSlotTable::of(const check::TypedGraph& graph) {
  if (const auto found = made_.find(&graph); found != made_.end()) return found->second;
  const Needs needs(graph, graph.outputs);
  SlotCollector collector(graph);
  for (uint32_t i = 0; i < graph.nodes.size(); ++i) {
    if (!needs.nodes[i]) continue;
    const check::Node& node = graph.nodes[i];
    if (node.row != nullptr && node.row->is<nodes::Image>())
      collector.made.of_node[i] = {collector.add(slot_of_image(graph, i))};
    if (node.callee == nullptr || !node.callee->needs(check::StageNeed::images)) continue;
    std::vector<uint32_t>& numbers = collector.made.of_node[i];
    for (const ImageSlot& slot : of(*node.callee).slots)
      numbers.push_back(collector.add(slot_in_caller(slot, graph, i)));
  }
  return made_[&graph] = std::move(collector.made);
}

ImageSlots image_slots(const check::TypedGraph& graph) {
  ImageSlotTable table;
  return table.of(graph);
}

}  // namespace isoshade::lower
