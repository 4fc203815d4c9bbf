// SPDX-License-Identifier: Apache-2.0
// What a post document has beside parameters, nodes and outputs.
#include <algorithm>

#include "compiler/graph/graph_builder.h"
#include "compiler/support/visible.h"

namespace isoshade::graph {

using support::Id;
using support::quote;

void GraphBuilder::read_images(const Json& images) {
  constexpr size_t most = 8;
  if (images.items.size() > most) {
    diagnostics_.report(Id::too_large, document_.span(images),
                        "a post reads at most " + std::to_string(most) + " further images");
    return;
  }
  for (const Json& item : images.items) {
    if (item.kind != Json::Kind::string) {
      diagnostics_.report(Id::wrong_type, document_.span(item),
                          "\"images\" are names, not " + std::string(kind_name(item.kind)));
      continue;
    }
    check_id(item.string, place_of(item), "an image");
    const auto same = std::ranges::find(graph_.images, item.string, &InputImage::name);
    const bool reserved = item.string == post_output;
    if (same != graph_.images.end() || reserved) {
      support::Diagnostic& report =
          diagnostics_.report(Id::duplicate_name, document_.span(item),
                              reserved ? "\"color\" is the image that the post goes over"
                                       : "two images are called " + quote(item.string));
      if (!reserved) report.note(graph_.span(same->place), "the other one");
      continue;
    }
    graph_.images.push_back({item.string, place_of(item)});
  }
}

void GraphBuilder::read_post(ObjectReader& reader) {
  using Need = ObjectReader::Need;
  if (const Json* images = reader.array("images", Need::optional)) read_images(*images);
  if (const Json* enabled = reader.value("enabled", Need::optional)) graph_.enabled = switch_of(*enabled);
  for (const Output& output : graph_.outputs) {
    if (output.name == post_output) continue;
    diagnostics_
        .report(Id::unknown_output, graph_.span(output.name_place),
                "a post has no output " + quote(output.name))
        .note("it gives \"color\" and nothing else");
  }
}

}  // namespace isoshade::graph
