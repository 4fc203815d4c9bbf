// SPDX-License-Identifier: Apache-2.0
#include "runtime/scene/load.h"

#include "compiler/graph/extend.h"
#include "runtime/scene/format.h"

namespace isoshade::scene {

static_assert(format::scene::extends.name == graph::extends_key);

std::optional<Scene> load_scene(const support::Source& source, const std::vector<std::string>& settings,
                                const graph::FileRule& files, support::Diagnostics& diagnostics) {
  auto document = graph::load_document(source, files, diagnostics);
  if (!document || !apply_settings(*document, settings, files, diagnostics)) return std::nullopt;
  return parse_scene(*document, diagnostics);
}

}  // namespace isoshade::scene
