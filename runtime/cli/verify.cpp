// SPDX-License-Identifier: Apache-2.0
// isoshade verify: renders scenes on several backends, compares every bit, and compares hashes with recorded ones.
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "runtime/cli/session.h"
#include "runtime/compare/compare.h"
#include "runtime/compare/golden.h"
#include "runtime/compare/report.h"
#include "runtime/render/render.h"
#include "runtime/scene/scene.h"

namespace isoshade::cli {

namespace {

struct NamedBackend {
  std::string name;  ///< "cpu", "cpu-8x2", "vulkan"
  std::unique_ptr<backends::Backend> backend;
};

class Verifier {
 public:
  Verifier(const VerifyArguments& arguments, const Common& common)
      : arguments_(arguments), common_(common), library_(make_library(common)) {}

  int run() {
    int result = prepare() ? success : failure;
    if (result == success) {
      for (const std::string& path : arguments_.scenes) result = std::max(result, verify_scene(path));
      if (arguments_.update && result == different)
        std::printf("no hash was recorded, because the images differ\n");
      else if (arguments_.update && result == success &&
               !compare::update_goldens(arguments_.golden, goldens_, diagnostics_))
        result = failure;
    }
    return flush(diagnostics_, common_) ? failure : result;
  }

 private:
  bool prepare() {
    if (arguments_.update && arguments_.golden.empty()) {
      diagnostics_
          .report(support::Id::missing_argument,
                  "--update records hashes in a golden file, but none is named")
          .suggest("add --golden FILE");
      return false;
    }
    std::vector<std::string> read = arguments_.scenes;
    read.push_back(arguments_.golden);
    if (!read_standard_input_once(read, diagnostics_)) return false;
    if (!arguments_.golden.empty() && std::ranges::count(arguments_.scenes, "-") != 0) {
      diagnostics_
          .report(support::Id::missing_argument, "a scene on standard input has no name under which to record a hash")
          .suggest("pass the scene as a file");
      return false;
    }
    if (!arguments_.golden.empty()) {
      // --update may create the file. If it exists, update_goldens reads it again before writing.
      if (!arguments_.update || std::filesystem::exists(arguments_.golden)) {
        auto read = compare::read_goldens(arguments_.golden, diagnostics_);
        if (!read) return false;
        if (!arguments_.update) goldens_ = std::move(*read);
      }
    }
    for (const std::string& name : arguments_.backends) {
      const std::vector<std::string> lanes =
          name == "cpu" && !arguments_.lanes.empty() ? arguments_.lanes : std::vector<std::string>{""};
      for (const std::string& count : lanes) {
        BackendChoice choice = arguments_.choice;
        choice.lanes = count;
        auto backend = make_backend(name, choice, common_, diagnostics_, cpu::Execution::compiled);
        if (backend == nullptr) return false;
        if (!common_.quiet)
          std::printf("%-12s %s\n", label(name, count).c_str(), backend->description().c_str());
        backends_.push_back({label(name, count), std::move(backend)});
      }
    }
    if (backends_.size() < 2 && arguments_.golden.empty()) {
      diagnostics_.report(support::Id::missing_argument, "a single backend cannot be compared with anything")
          .suggest("name a second one in --backends, several --lanes, or recorded hashes with --golden FILE");
      return false;
    }
    return true;
  }

  static std::string label(const std::string& name, const std::string& lanes) {
    return lanes.empty() ? name : name + "-" + lanes;
  }

  int verify_scene(const std::string& path) {
    const auto scene = load_scene(path, arguments_.changes, common_, diagnostics_);
    if (!scene) return failure;
    int result = success;
    std::vector<Size> sizes = arguments_.sizes;
    if (sizes.empty()) sizes.push_back({scene->width, scene->height});
    for (const Size size : sizes) result = std::max(result, verify_size(path, *scene, size));
    return result;
  }

  int verify_size(const std::string& path, const scene::Scene& scene, Size size) {
    render::PlanOptions options;
    options.width = size.width;
    options.height = size.height;
    options.compiler.library = &library_;
    options.compiler.tier = arguments_.precision;
    options.compiler.skips = arguments_.skips;
    const auto plan = render::plan_frame(scene, options, diagnostics_);
    if (!plan) return failure;
    const std::string_view tier = functions::tier_name(arguments_.precision);
    const bool usual = arguments_.precision == functions::Tier::standard;
    const std::string samples = scene.samples > 1 ? ", " + std::to_string(scene.samples) + " samples" : "";
    std::printf("%s %dx%d%s%s%s\n", path.c_str(), size.width, size.height, samples.c_str(),
                usual ? "" : " precision ", usual ? "" : tier.data());
    int result = success;
    std::vector<backends::Image> images(backends_.size());
    for (size_t i = 0; i < backends_.size(); ++i) {
      progress(common_, "  rendering on " + backends_[i].name);
      render::DrawStats stats;
      if (!render::render(*plan, *backends_[i].backend, images[i], stats, diagnostics_)) return failure;
      if (i > 0) continue;  // the others either differ or have the same pixels
      render::warn_non_finite(scene, *plan, stats.non_finite, diagnostics_);
      if (!arguments_.fail_on_nan || stats.non_finite.none()) continue;
      std::fputs(not_finite_text, stderr);
      result = different;
    }
    for (size_t i = 1; i < images.size(); ++i)
      result = std::max(result, compare_with_first(path, scene, images, i));
    return std::max(result, compare_with_golden(path, scene, images[0]));
  }

  int compare_with_first(const std::string& path, const scene::Scene& scene,
                         const std::vector<backends::Image>& images, size_t other) {
    const NamedBackend& a = backends_[0];
    const NamedBackend& b = backends_[other];
    const compare::Comparison comparison = compare::compare(images[0], images[other]);
    std::printf("%s  (%s, %s)\n", compare::describe(comparison, a.name, b.name).c_str(), a.name.c_str(),
                b.name.c_str());
    if (comparison.identical()) return success;
    if (!arguments_.report.empty()) {
      const std::string folder =
          (std::filesystem::path(arguments_.report) /
           (std::filesystem::path(path).stem().string() + "-" + std::to_string(images[0].width) + "x" +
            std::to_string(images[0].height) + "-" + b.name))
              .string();
      if (!compare::write_report(folder, {a.name, a.backend->description(), &images[0]},
                                 {b.name, b.backend->description(), &images[other]}, comparison,
                                 scene.output.encoding, scene.output.exposure, diagnostics_))
        return failure;
      std::printf("  report: %s\n", folder.c_str());
    }
    return different;
  }

  int compare_with_golden(const std::string& path, const scene::Scene& scene, const backends::Image& image) {
    const std::string hash = compare::image_hash(image);
    std::printf("  sha256 %s\n", hash.c_str());
    if (arguments_.golden.empty()) return success;
    const compare::Golden found{
        image.width, image.height, hash,
        compare::encoded_hash(image.width, image.height,
                              scene::encode(image.rgba, scene.output.encoding, scene.output.exposure))};
    const std::string key = compare::golden_key(path, arguments_.golden);
    const std::string tier(functions::tier_name(arguments_.precision));
    if (arguments_.update) {
      goldens_[key][tier] = found;
      return success;
    }
    const std::string mismatch = compare::golden_mismatch(goldens_, key, tier, found);
    if (mismatch.empty()) return success;
    std::printf("  %s\n", mismatch.c_str());
    return different;
  }

  const VerifyArguments& arguments_;
  const Common& common_;
  check::Library library_;
  support::Diagnostics diagnostics_ = make_diagnostics(common_);
  std::vector<NamedBackend> backends_;
  compare::Goldens goldens_;  ///< those read from the file; with --update, those to write to it
};

}  // namespace

int verify(const VerifyArguments& arguments, const Common& common) {
  return Verifier(arguments, common).run();
}

}  // namespace isoshade::cli
