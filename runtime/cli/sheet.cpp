// SPDX-License-Identifier: Apache-2.0
// isoshade sheet: one scene with several values of one or two parameters, side by side in one image.
#include <algorithm>

#include "compiler/support/visible.h"
#include "runtime/cli/caption.h"
#include "runtime/cli/session.h"
#include "runtime/render/render.h"
#include "runtime/scene/image_file.h"
#include "runtime/scene/load.h"
#include "runtime/scene/output_file.h"

namespace isoshade::cli {
namespace {

constexpr int usual_width = 240;  ///< of each picture
constexpr int gap = 10;           ///< around pictures and captions
constexpr int64_t max_side = 8192;

/// Where pictures and captions lie.
struct Layout {
  Size picture;
  int columns = 1, rows = 1;
  int left = gap, top = gap;  ///< of the first picture

  int x(int column) const { return left + column * (picture.width + gap); }
  int y(int row) const { return top + row * (picture.height + gap); }
};

int widest(const std::vector<std::string>& texts) {
  int width = 0;
  for (const std::string& text : texts) width = std::max(width, Canvas::text_width(text));
  return width;
}

Size size_of_picture(const SheetArguments& arguments, const scene::Scene& scene) {
  if (arguments.size) return *arguments.size;
  const int64_t height = (int64_t{usual_width} * scene.height + scene.width / 2) / scene.width;
  return {usual_width, static_cast<int>(std::clamp<int64_t>(height, 1, max_side))};
}

std::optional<Layout> layout_of(const SheetArguments& arguments, Size picture, support::Diagnostics& diagnostics) {
  Layout layout{picture};
  const auto& axes = arguments.axes;
  layout.columns = static_cast<int>(axes[0].values.size());
  layout.top += 2 * (Canvas::text_height + gap);
  if (axes.size() > 1) {
    layout.rows = static_cast<int>(axes[1].values.size());
    layout.left += std::max(widest(axes[1].values), Canvas::text_width(axes[1].name)) + gap;
  }
  const int64_t width = int64_t{layout.left} + int64_t{layout.columns} * (picture.width + gap);
  const int64_t height = int64_t{layout.top} + int64_t{layout.rows} * (picture.height + gap);
  if (width <= max_side && height <= max_side) return layout;
  diagnostics
      .report(support::Id::too_large, "the sheet would have " + std::to_string(width) + " x " + std::to_string(height) +
                                          " pixels; at most " + std::to_string(max_side) + " each way")
      .suggest("make the pictures smaller with --size, or vary over fewer values");
  return std::nullopt;
}

/// The names of both parameters at the upper left, the values above columns and before rows.
void write_captions(Canvas& canvas, const Layout& layout, const std::vector<VariedParameter>& axes) {
  canvas.write(layout.left, gap, axes[0].name);
  const int values_y = 2 * gap + Canvas::text_height;
  for (int i = 0; i < layout.columns; ++i) {
    const std::string& value = axes[0].values[static_cast<size_t>(i)];
    const int spare = layout.picture.width - Canvas::text_width(value);
    canvas.write(layout.x(i) + std::max(0, spare / 2), values_y, value);
  }
  if (axes.size() < 2) return;
  canvas.write(gap, values_y, axes[1].name);
  for (int i = 0; i < layout.rows; ++i)
    canvas.write(gap, layout.y(i) + (layout.picture.height - Canvas::text_height) / 2,
                 axes[1].values[static_cast<size_t>(i)]);
}

int render_sheet(const SheetArguments& arguments, const Common& common, support::Diagnostics& diagnostics) {
  auto output = image_output(arguments.output, arguments.output_choice, arguments.choice.threads, diagnostics);
  if (!output) return failure;
  const scene::ImageFormat& format = *output->format;
  if (format.write_bytes == nullptr) {
    diagnostics
        .report(support::Id::unwritable_file, "a sheet has 8 bits per channel, and " + support::quote(arguments.output) + " floats")
        .suggest("end the name in .png");
    return failure;
  }
  check::Library library = make_library(common);
  std::optional<Layout> layout;
  std::optional<Canvas> canvas;
  std::unique_ptr<backends::Backend> backend;
  const auto& axes = arguments.axes;
  const size_t rows = axes.size() > 1 ? axes[1].values.size() : 1;
  for (size_t row = 0; row < rows; ++row) {
    for (size_t column = 0; column < axes[0].values.size(); ++column) {
      SceneChanges changes = arguments.changes;
      changes.settings.push_back(axes[0].name + "=" + axes[0].values[column]);
      if (axes.size() > 1) changes.settings.push_back(axes[1].name + "=" + axes[1].values[row]);
      const auto scene = load_scene(arguments.scene, changes, common, diagnostics);
      if (!scene) return failure;
      const Size size = size_of_picture(arguments, *scene);
      if (!layout) {
        layout = layout_of(arguments, size, diagnostics);
        if (!layout) return failure;
      }
      render::PlanOptions options;
      options.width = layout->picture.width;
      options.height = layout->picture.height;
      // One program draws all pictures.
      for (const VariedParameter& axis : axes) options.changing.insert(axis.name.substr(axis.name.rfind('.') + 1));
      options.compiler.library = &library;
      options.compiler.tier = arguments.precision;
      const auto plan = render::plan_frame(*scene, options, diagnostics);
      if (!plan || !may_write(arguments.output, diagnostics)) return failure;
      if (backend == nullptr) backend = make_backend(arguments.backend, arguments.choice, common, diagnostics);
      if (backend == nullptr) return failure;
      if (!canvas) {
        canvas.emplace(layout->x(layout->columns), layout->y(layout->rows));
        write_captions(*canvas, *layout, axes);
      }
      progress(common, "picture " + std::to_string(row * axes[0].values.size() + column + 1) + " of " +
                           std::to_string(rows * axes[0].values.size()));
      backends::Image image;
      render::DrawStats stats;
      if (!render::render(*plan, *backend, image, stats, diagnostics)) return failure;
      output->options.encoding = scene->output.encoding;
      output->options.exposure = scene->output.exposure;
      const scene::ImageView view{image.width, image.height, image.rgba, image.depth};
      canvas->place(layout->x(static_cast<int>(column)), layout->y(static_cast<int>(row)), image.width,
                    scene::encode_for(format, view, output->options, arguments.output, diagnostics));
      render::warn_non_finite(*scene, *plan, stats.non_finite, diagnostics);
    }
  }
  const std::string bytes = format.write_bytes({canvas->width(), canvas->height(), canvas->rgba()}, output->options);
  return scene::write_file(arguments.output, bytes, diagnostics) ? success : failure;
}

}  // namespace

int sheet(const SheetArguments& arguments, const Common& common) {
  support::Diagnostics diagnostics = make_diagnostics(common);
  const int result = render_sheet(arguments, common, diagnostics);
  return flush(diagnostics, common) ? failure : result;
}

}  // namespace isoshade::cli
