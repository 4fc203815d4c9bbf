// SPDX-License-Identifier: Apache-2.0
#include "runtime/page/page.h"

#include <algorithm>
#include <string_view>

#include "compiler/emit/forward.h"
#include "compiler/support/assert.h"
#include "compiler/support/visible.h"
#include "runtime/page/data.h"
#include "runtime/page/encode.h"
#include "runtime/page/shaders.h"
#include "runtime/render/plan.h"
#include "runtime/render/render.h"

namespace isoshade::page {
namespace {

std::string_view file(std::string_view path) {
  const auto files = page_files();
  const auto found = std::ranges::find(files, path, &PageFile::path);
  support::assert_that(found != files.end(), "the page lacks one of its files");
  return found->text;
}

std::string scripts() {
  std::string text;
  for (const PageFile& part : page_files())
    if (part.path.ends_with(".js")) text.append("\n").append(part.text);
  return text;
}

/// The page around the data. The texts are put in once: no text that is put in is searched for further places.
std::string assemble(const std::string& data) {
  const std::string_view style = file("page.css");
  const std::string script = scripts();
  const std::string policy = "default-src 'none'; img-src data:; style-src " + policy_source(style) +
                             "; script-src " + policy_source(script);
  const std::pair<std::string_view, std::string_view> parts[] = {
      {"@POLICY@", policy}, {"@STYLE@", style}, {"@DATA@", data}, {"@SCRIPT@", script}};
  std::string page;
  std::string_view rest = file("page.html");
  for (const auto& [mark, text] : parts) {
    const size_t at = rest.find(mark);
    support::assert_that(at != std::string_view::npos, "a place of the page is missing");
    page.append(rest.substr(0, at)).append(text);
    rest.remove_prefix(at + mark.size());
  }
  return page.append(rest);
}

bool report_large(const scene::Scene& scene, size_t bytes, support::Diagnostics& diagnostics) {
  if (bytes <= max_page_bytes) return false;
  diagnostics
      .report(support::Id::too_large, "the page of scene " + support::quote(scene.name) + " has " +
                                          std::to_string(bytes >> 20) + " MiB; at most " +
                                          std::to_string(max_page_bytes >> 20))
      .suggest("use meshes of fewer segments, fewer copies or smaller images");
  return true;
}

/// Reports effects that read what is opaque behind them.
bool report_readers(const scene::Scene& scene, const render::Plan& plan, support::Diagnostics& diagnostics) {
  for (const render::RecordOrigin& origin : plan.origins) {
    if (!origin.pass->reads_scene) continue;
    const scene::Object& object = scene.objects[origin.object];
    diagnostics
        .report(support::Id::unsupported, object.effect_where,
                "a page has no picture of what is opaque, which the effect of object " + support::quote(object.name) +
                    " reads (scenecolor, scenedepth)")
        .suggest("draw the scene with `isoshade render`, or give the object another effect");
    return true;
  }
  return false;
}

/// The scene as the page draws it where it compares pictures: of one sample a pixel.
struct Reference {
  render::Plan plan;
  backends::Image image;
};
bool draw_reference(const scene::Scene& scene, const driver::CompileOptions& compiler, Reference& reference,
                    backends::Backend& backend, support::Diagnostics& diagnostics) {
  scene::Scene single = scene;
  single.samples = 1;
  render::PlanOptions options;
  options.width = std::min(reference_width, scene.width);
  options.height = std::max(1, (scene.height * options.width + scene.width / 2) / scene.width);
  options.compiler = compiler;
  support::Diagnostics repeated;  // what the plan of the page has reported already
  auto plan = render::plan_frame(single, options, repeated);
  if (!plan) {
    for (const support::Diagnostic& report : repeated.all())
      if (report.severity == support::Severity::error)
        diagnostics.report(report.id, report.where, report.message).suggest(report.fix);
    return false;
  }
  reference.plan = *std::move(plan);
  render::DrawStats stats;
  return render::render(reference.plan, backend, reference.image, stats, diagnostics);
}

/// Tells what the page draws otherwise than the backends.
std::vector<std::string> find_differences(const scene::Scene& scene, support::Diagnostics& diagnostics) {
  std::vector<std::string> warnings;
  const auto warn = [&](const support::Span& where, const std::string& text) {
    warnings.push_back(text);
    diagnostics.report(support::Id::page_limit, where, text);
  };
  if (scene.samples > 1)
    warn(scene.samples_where, "the page draws one sample a pixel, not " + std::to_string(scene.samples));
  for (const scene::Light& light : scene.lights)
    if (light.shadow)
      warn(light.shadow_where, "the page draws without the shadow of light " + support::quote(light.name));
  if (scene.environment)
    warn(scene.environment->where, "the page draws without the environment");
  if (scene.lights.size() > emit::most_forward_lights)
    warn({}, "the page draws with " + std::to_string(emit::most_forward_lights) + " of the scene's " +
                 std::to_string(scene.lights.size()) + " lights");
  return warnings;
}

}  // namespace

std::optional<std::string> make_page(const scene::Scene& scene, const PageOptions& options,
                                     backends::Backend& backend, support::Diagnostics& diagnostics) {
  render::PlanOptions all;
  all.compiler.skips = interface::Skips::none();
  all.disabled = true;
  all.compiler.library = options.library;
  all.compiler.tier = options.tier;
  scene::Scene drawn = scene;
  drawn.environment.reset();  // its maps are large, and the page's shaders do not read them
  for (scene::Light& light : drawn.lights) light.shadow.reset();
  const auto plan = render::plan_frame(drawn, all, diagnostics);
  if (!plan || report_readers(scene, *plan, diagnostics) || report_large(scene, array_bytes(*plan), diagnostics))
    return std::nullopt;
  const auto shaders = compile_shaders(*plan, options, diagnostics);
  if (!shaders) return std::nullopt;
  Reference reference;
  if (!draw_reference(scene, all.compiler, reference, backend, diagnostics)) return std::nullopt;
  const std::vector<std::string> warnings = find_differences(scene, diagnostics);
  std::string page =
      assemble(script_json(page_data({scene, *plan, *shaders, reference.image, reference.plan, warnings})));
  if (report_large(scene, page.size(), diagnostics)) return std::nullopt;
  return page;
}

}  // namespace isoshade::page
