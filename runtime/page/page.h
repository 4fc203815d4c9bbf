// SPDX-License-Identifier: Apache-2.0
// A scene as one HTML page that needs no network: WebGL2 draws it, the mouse turns it, and a panel changes the parameters
// of its effects and posts.
#pragma once

#include <optional>
#include <string>

#include "backends/backend.h"
#include "compiler/check/library.h"
#include "compiler/functions/tier.h"
#include "runtime/scene/scene.h"

namespace isoshade::page {

/// Browsers open larger pages only slowly, or not at all.
inline constexpr size_t max_page_bytes = size_t{64} << 20;
/// The width of the picture that the page compares its own with; narrower for scenes that are narrower.
inline constexpr int reference_width = 256;

struct PageOptions {
  check::Library* library = nullptr;  ///< of function documents; required
  functions::Tier tier = functions::Tier::standard;
};

/// The text of the page. `backend` draws the picture that the page compares its own with. Reports what does not compile,
/// a page that is too large, and, as warnings, what WebGL2 draws otherwise.
std::optional<std::string> make_page(const scene::Scene& scene, const PageOptions& options,
                                     backends::Backend& backend, support::Diagnostics& diagnostics);

}  // namespace isoshade::page
