// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/front.h"

#include "compiler/check/check.h"
#include "compiler/driver/dumps.h"
#include "compiler/graph/extend.h"
#include "compiler/lower/screen.h"

namespace isoshade::driver {

using support::Diagnostics;

std::shared_ptr<const check::TypedGraph> read_graph(const support::Source& source,
                                                    std::optional<graph::DocumentKind> wanted,
                                                    const CompileOptions& options, Diagnostics& diagnostics) {
  const auto document = graph::load_document(source, options.library->files(), diagnostics);
  if (!document) return nullptr;
  if (options.dump) options.dump("document", [&] { return dump_document(*document); });
  auto graph = graph::build_graph(*document, diagnostics);
  if (!graph) return nullptr;
  if (options.dump) options.dump("graph", [&] { return dump_graph(*graph); });
  if (wanted && graph->kind != *wanted) {
    diagnostics.report(support::Id::wrong_kind,
                       document->span(*document->root.find(graph::kind_name(graph->kind))),
                       "this is a document of kind \"" + std::string(graph::kind_name(graph->kind)) +
                           "\", but \"" + std::string(graph::kind_name(*wanted)) + "\" is needed here");
    return nullptr;
  }
  auto typed = check::check(std::move(*graph), *options.library, diagnostics);
  if (typed == nullptr) return nullptr;
  if (options.dump) options.dump("typed", [&] { return dump_typed(*typed); });
  return typed;
}

namespace {

int words_of(graph::Type type) {
  const bool one = type == graph::Type::boolean || type == graph::Type::integer;
  return one ? 1 : graph::float_count(type);
}

}  // namespace

Field field(const std::string& name, graph::Type type) {
  return {name, std::string(graph::type_name(type)), words_of(type), {}, {}, {}};
}

namespace {

/// The words of a parameter's value in a record: floats, also for booleans (0, 1) and integers.
std::vector<float> record_words(const graph::Literal& literal, int words) {
  if (literal.kind == graph::Literal::Kind::boolean) return {literal.boolean ? 1.0f : 0.0f};
  if (literal.kind == graph::Literal::Kind::numbers) return literal.numbers;
  return std::vector<float>(static_cast<size_t>(words), literal.number);
}

}  // namespace

std::vector<Field> input_fields(const check::TypedGraph& typed) {
  std::vector<Field> fields;
  for (const graph::Input& input : typed.graph.inputs) {
    fields.push_back(field(input.name, input.type));
    fields.back().min = input.min;
    fields.back().max = input.max;
    fields.back().names = input.names;
    fields.back().dynamic = input.dynamic;
  }
  return fields;
}

std::vector<Field> output_fields(const check::TypedGraph& typed) {
  std::vector<Field> fields;
  for (size_t i = 0; i < typed.graph.outputs.size(); ++i)
    fields.push_back(field(typed.graph.outputs[i].name, typed.outputs[i].type));
  return fields;
}

std::vector<Image> images_of(const check::TypedGraph& typed) {
  std::vector<Image> images;
  for (lower::ImageSlot& slot : lower::image_slots(typed).slots) {
    const std::string file = slot.path.empty() ? "" : graph::path_beside(slot.place.file->path(), slot.path);
    images.push_back({std::move(slot), file});
  }
  return images;
}

ParameterBlock parameter_block(const check::TypedGraph& typed) {
  ParameterBlock block{input_fields(typed), {}, {}};
  for (size_t i = 0; i < block.fields.size(); ++i)
    block.fields[i].value = record_words(*typed.graph.inputs[i].value, block.fields[i].words);
  if (typed.graph.kind == graph::DocumentKind::effect) block.images = images_of(typed);
  if (typed.graph.kind != graph::DocumentKind::post) return block;
  for (const lower::TapSum& sum : lower::tap_sums(typed)) {
    block.taps.push_back(field(typed.graph.nodes[sum.node].id, graph::Type::integer));
    block.taps.back().value = {static_cast<float>(sum.taps)};
  }
  return block;
}

}  // namespace isoshade::driver
