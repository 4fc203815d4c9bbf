// SPDX-License-Identifier: Apache-2.0
#include "runtime/cli/frames.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <unistd.h>

#include "compiler/support/visible.h"
#include "runtime/cli/argument_texts.h"
#include "runtime/cli/frame_times.h"
#include "runtime/lanes/float_rules.h"
#include "runtime/render/samples.h"
#include "runtime/render/clock.h"
#include "runtime/scene/animation_file.h"
#include "runtime/scene/image_file.h"
#include "runtime/scene/load.h"
#include "runtime/scene/output_file.h"
#include "runtime/scene/placement.h"

namespace isoshade::cli {
namespace {

using support::Diagnostics;

/// How far it is, on a terminal, in one line that is written again and again.
class ProgressBar {
 public:
  ProgressBar(const Common& common, int count) : shown_(!common.quiet && isatty(STDERR_FILENO) == 1), count_(count) {}
  ~ProgressBar() { clear(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(int done) const {
    if (!shown_) return;
    constexpr int width = 30;
    const int filled = width * done / count_;
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
    const double left = done > 0 ? seconds / done * (count_ - done) : 0;
    std::fprintf(stderr, "\r[%s%s] %d of %d frames, %.0f s left \x1b[K", std::string(static_cast<size_t>(filled), '#').c_str(),
                 std::string(static_cast<size_t>(width - filled), ' ').c_str(), done, count_, left);
  }
  void clear() const {
    if (shown_) std::fputs("\r\x1b[K", stderr);
  }

 private:
  bool shown_;
  int count_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// Adds the diagnostics of a frame that no frame before has had.
void append_new(Diagnostics& all, const Diagnostics& frame) {
  for (const support::Diagnostic& one : frame.all()) {
    const auto is_same = [&](const support::Diagnostic& other) {
      return other.id == one.id && other.message == one.message && other.where.begin == one.where.begin;
    };
    if (std::ranges::none_of(all.all(), is_same)) all.all().push_back(one);
  }
}

class FrameSequence {
 public:
  FrameSequence(const RenderArguments& arguments, const Common& common, Diagnostics& diagnostics)
      : arguments_(arguments),
        common_(common),
        all_(diagnostics),
        times_(*arguments.frames),
        format_(scene::animation_format_of(arguments.output)),
        numbered_(NumberedPath::parse(arguments.output)),
        renderer_(arguments, common) {}

  int run() {
    if (writes() && !check_output()) return failure;
    const ProgressBar bar(common_, times_.count);
    int result = success;
    for (int i = 0; i < times_.count; ++i) {
      bar.show(i);
      Diagnostics diagnostics = make_diagnostics(common_);
      result = std::max(result, render(i, diagnostics));
      append_new(all_, diagnostics);
      if (result == failure || diagnostics.has_errors()) return failure;
    }
    bar.clear();
    if (file_ && !scene::write_file(arguments_.output, file_->finish(), all_)) return failure;
    if (!report_times()) return failure;
    if (result == different) std::fputs(not_finite_text, stderr);
    return result;
  }

 private:
  /// Otherwise frames are only measured.
  bool writes() const { return !arguments_.output.empty(); }

  bool check_output() {
    const OutputChoice& choice = arguments_.output_choice;
    if (format_) {
      if (choice.format.empty() && choice.compression.empty() && !choice.quality) return true;
      all_.report(support::Id::unwritable_file,
                  "--format, --compression and --quality are not for one file of all frames")
          .suggest("leave them out, or write frame_%04d.png");
      return false;
    }
    if (numbered_ || arguments_.output == "-") {
      output_ = image_output(path_of(0), choice, arguments_.choice.threads, all_);
      return output_.has_value();
    }
    all_.report(support::Id::unwritable_file,
                support::quote(arguments_.output) + " does not tell the names of the frames")
        .note("the name needs exactly one field for the number, %d or %04d; a percent sign is written %%")
        .suggest("write frame_%04d.png, or FILE.apng or FILE.gif for one file");
    return false;
  }

  std::string path_of(int frame) const { return numbered_ && !format_ ? numbered_->of(frame) : arguments_.output; }

  /// Nothing for the scene's own time.
  std::optional<float> time_of(int frame) const {
    if (times_.at_scene_time) return std::nullopt;
    const double first = static_cast<double>(times_.first), last = static_cast<double>(times_.last);
    if (times_.count == 1) return times_.first;
    return static_cast<float>(first + (last - first) * frame / (times_.count - 1));
  }

  /// Makes the scene of a frame. One that has no animation is loaded once.
  bool load(int frame, Diagnostics& diagnostics) {
    const std::optional<float> time = time_of(frame);
    if (!document_) {
      const support::Source source = graph::read_source(arguments_.scene, diagnostics);
      if (source == nullptr) return false;
      document_ = scene::SceneDocument::load(source, arguments_.changes.settings, make_library(common_).files(),
                                             diagnostics);
      if (!document_) return false;
    }
    if (!scene_ || document_->is_animated()) {
      scene_ = document_->at(time, diagnostics);
      if (!scene_ || !apply_changes(arguments_.changes, *scene_, diagnostics)) return false;
      if (arguments_.turntable && scene_->before == nullptr) scene_->before = std::make_shared<scene::Scene>(*scene_);
      camera_ = scene_->camera;
      if (arguments_.turntable) camera_before_ = scene_->before->camera;
    }
    if (time) scene_->time = *time;
    if (arguments_.turntable) turn(frame);
    return true;
  }

  /// Turns the camera of the frame, and that of the frame before as the frame before is turned.
  void turn(int frame) {
    scene::Scene& before = *scene_->before;
    if (!document_->is_animated())
      before.time = static_cast<float>(static_cast<double>(scene_->time) -
                                       1 / static_cast<double>(scene_->frames_per_second));
    const lanes::FpGuard guard;
    scene_->camera = scene::turned(camera_, frame, times_.count);
    before.camera = scene::turned(camera_before_, (frame + times_.count - 1) % times_.count, times_.count);
  }

  int render(int frame, Diagnostics& diagnostics) {
    render::Clock clock, whole;
    StepTimes& steps = measured_.frames.emplace_back();
    if (!load(frame, diagnostics)) return failure;
    steps[Step::load] = clock.lap();
    const render::Plan* plan = renderer_.plan(*scene_, diagnostics);
    steps[Step::plan] = clock.lap();
    if (plan == nullptr || (writes() && !may_write(path_of(frame), diagnostics))) return failure;
    render::DrawStats stats;
    if (!renderer_.draw(*plan, stats, diagnostics)) return failure;
    steps[Step::build] = stats.build_seconds;
    steps[Step::vertices] = stats.transform_seconds;
    steps[Step::clip] = stats.clip_seconds;
    steps[Step::draw] = stats.draw_seconds;
    steps[Step::posts] = stats.post_seconds;
    clock.lap();
    if (writes() && !write(frame, diagnostics)) return failure;
    steps[Step::write] = clock.lap();
    render::warn_non_finite(*scene_, *plan, stats.non_finite, diagnostics);
    steps[Step::frame] = whole.lap();
    const backends::Target& target = plan->frame.picture().target;
    const int side = render::samples_each_way(plan->samples);
    measured_.width = target.width / side;
    measured_.height = target.height / side;
    measured_.samples = plan->samples;
    if (frame == 0)
      for (const auto& skipped : {plan->stats.in_programs, plan->stats.skips, stats.skips})
        measured_.skipped.insert(measured_.skipped.end(), skipped.begin(), skipped.end());
    measured_.kept_frames += stats.is_kept ? 1 : 0;
    measured_.views += stats.views;
    measured_.kept_views += stats.kept_views;
    return arguments_.fail_on_nan && !stats.non_finite.none() ? different : success;
  }

  bool write(int frame, Diagnostics& diagnostics) {
    const scene::Output& output = scene_->output;
    const int threads = arguments_.choice.threads;
    const scene::ImageView image = renderer_.image();
    if (output_) {
      output_->options.encoding = output.encoding;
      output_->options.exposure = output.exposure;
      return scene::write_image(path_of(frame), *output_->format, image, output_->options, diagnostics);
    }
    if (!file_) {
      // In real time; a single picture has no next one.
      const double length = static_cast<double>(times_.last) - static_cast<double>(times_.first);
      const double seconds = length > 0 && times_.count > 1 ? length / (times_.count - 1)
                                                            : 1 / static_cast<double>(scene_->frames_per_second);
      file_.emplace(*format_, image.width, image.height, seconds, threads);
    }
    file_->add(scene::encode(image.rgba, output.encoding, output.exposure, scene::Alpha::straight, threads));
    return true;
  }

  bool report_times() {
    measured_.scene = arguments_.scene;
    measured_.backend = renderer_.backend()->description();
    measured_.threads = renderer_.backend()->workers().count();
    if (arguments_.stats) std::fputs(text(measured_).c_str(), stderr);
    const std::string& path = arguments_.stats_json;
    return path.empty() || (may_write(path, all_) && scene::write_file(path, json(measured_), all_));
  }

  const RenderArguments& arguments_;
  const Common& common_;
  Diagnostics& all_;
  FrameTimes times_;
  std::optional<scene::AnimationFormat> format_;
  std::optional<NumberedPath> numbered_;
  std::optional<ImageOutput> output_;  ///< of images one by one
  std::optional<scene::SceneDocument> document_;
  std::optional<scene::Scene> scene_;     ///< of the frame
  scene::Camera camera_, camera_before_;  ///< of the scene and the one before, not turned
  SceneRenderer renderer_;
  std::optional<scene::AnimationFile> file_;
  Measured measured_;
};

}  // namespace

int render_frames(const RenderArguments& arguments, const Common& common, Diagnostics& diagnostics) {
  return FrameSequence(arguments, common, diagnostics).run();
}

}  // namespace isoshade::cli
