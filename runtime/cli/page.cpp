// SPDX-License-Identifier: Apache-2.0
// isoshade page: writes a scene as an HTML page.
#include "runtime/page/page.h"

#include "runtime/cli/session.h"
#include "runtime/scene/output_file.h"

namespace isoshade::cli {

namespace {

bool write_page(const PageArguments& arguments, const Common& common, support::Diagnostics& diagnostics) {
  const auto scene = load_scene(arguments.scene, arguments.changes, common, diagnostics);
  if (!scene) return false;
  check::Library library = make_library(common);
  const page::PageOptions options{.library = &library, .tier = arguments.precision};
  const auto backend = make_backend("cpu", arguments.choice, common, diagnostics);
  if (backend == nullptr) return false;
  const auto text = page::make_page(*scene, options, *backend, diagnostics);
  return text && may_write(arguments.output, diagnostics) &&
         scene::write_file(arguments.output, *text, diagnostics);
}

}  // namespace

int page(const PageArguments& arguments, const Common& common) {
  support::Diagnostics diagnostics = make_diagnostics(common);
  const bool done = write_page(arguments, common, diagnostics);
  return flush(diagnostics, common) || !done ? failure : success;
}

}  // namespace isoshade::cli
