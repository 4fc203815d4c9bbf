// SPDX-License-Identifier: Apache-2.0
// isoshade fmt: brings documents into canonical layout.

#include <cstdio>

#include "compiler/graph/document.h"
#include "runtime/cli/session.h"
#include "runtime/scene/output_file.h"

namespace isoshade::cli {

int format(const FormatArguments& arguments, const Common& common) {
  support::Diagnostics diagnostics = make_diagnostics(common);
  int result = success;
  for (const std::string& path : arguments.documents) {
    const support::Source source = graph::read_source(path, diagnostics);
    const auto document = source != nullptr ? graph::parse_document(source, diagnostics) : std::nullopt;
    if (!document) continue;
    const std::string text = graph::format(*document);
    if (arguments.check) {
      if (text == source->text()) continue;
      std::printf("%s\n", source->path().c_str());
      result = different;
    } else if (path == "-" || text != source->text()) {
      scene::write_file(path, text, diagnostics);
    }
  }
  return flush(diagnostics, common) ? failure : result;
}

}  // namespace isoshade::cli
