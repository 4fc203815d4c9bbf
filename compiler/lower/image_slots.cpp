// SPDX-License-Identifier: Apache-2.0
#include "compiler/lower/image_slots.h"

#include <algorithm>
#include <tuple>
#include <unordered_set>

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

/// The slot of one node alone.
ImageSlot slot_of(const check::TypedGraph& graph, uint32_t index) {
  const check::Node& node = graph.nodes[index];
  const Operand& file = graph.operands_of(node)[port::file];
  ImageSlot slot;
  if (file.from == Operand::From::input) {
    const graph::Input& input = graph.graph.inputs[file.index];
    slot.name = slot.parameter = input.name;
    slot.path = input.value->string;
    slot.place = input.value_place;
  } else {
    slot.name = graph.graph.nodes[index].id;
    slot.path = graph.files[file.index].path;
    slot.place = graph.files[file.index].place;
  }
  slot.decoding = decoding_of(graph, node);
  slot.samplings = {sampling_of(graph, node)};
  slot.mips = check::may_be_trilinear(graph, node);
  return slot;
}

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

ImageSlots image_slots(const check::TypedGraph& graph) {
  ImageSlots result;
  result.of_node.resize(graph.nodes.size());
  const Needs needs(graph, graph.outputs);
  std::unordered_set<std::string> parameters;
  for (const std::vector<std::string>& names : parameter_names(graph))
    parameters.insert(names.begin(), names.end());
  for (const graph::Input& input : graph.graph.inputs) parameters.insert(input.name);
  const auto same = [](const ImageSlot& a, const ImageSlot& b) {
    return std::tie(a.parameter, a.path, a.decoding) == std::tie(b.parameter, b.path, b.decoding);
  };
  for (uint32_t i = 0; i < graph.nodes.size(); ++i) {
    if (!needs.nodes[i] || graph.nodes[i].row == nullptr || !graph.nodes[i].row->is<nodes::Image>()) continue;
    ImageSlot slot = slot_of(graph, i);
    const auto found =
        std::ranges::find_if(result.slots, [&](const ImageSlot& other) { return same(slot, other); });
    result.of_node[i] = static_cast<uint32_t>(found - result.slots.begin());
    if (found != result.slots.end()) {
      found->mips |= slot.mips;
      if (std::ranges::find(found->samplings, slot.samplings[0]) == found->samplings.end())
        found->samplings.push_back(slot.samplings[0]);
      continue;
    }
    // A parameter that is read in two ways has two slots; none is called as a parameter or a column of one.
    const auto taken = [&] {
      return (slot.name != slot.parameter && parameters.contains(slot.name)) ||
             std::ranges::find(result.slots, slot.name, &ImageSlot::name) != result.slots.end();
    };
    while (taken()) slot.name += "_";
    result.slots.push_back(std::move(slot));
  }
  return result;
}

}  // namespace isoshade::lower
