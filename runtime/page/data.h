// SPDX-License-Identifier: Apache-2.0
// What a page is made from, as JSON. web/data.js reads it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "backends/backend.h"
#include "runtime/page/shaders.h"
#include "runtime/render/plan.h"
#include "runtime/scene/scene.h"

namespace isoshade::page {

/// A plan for a page has every pass and post, seen or not, enabled or not.
struct PageContent {
  const scene::Scene& scene;
  const render::Plan& plan;
  const Shaders& shaders;
  const backends::Image& reference;        ///< the cpu backend's picture
  const render::Plan& reference_plan;      ///< what it was drawn from
  const std::vector<std::string>& warnings;  ///< what the page cannot show
};

/// The bytes that the arrays of the page take in it.
size_t array_bytes(const render::Plan& plan);

/// The JSON.
std::string page_data(const PageContent& content);

}  // namespace isoshade::page
