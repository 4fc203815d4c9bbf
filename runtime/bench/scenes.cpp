// SPDX-License-Identifier: Apache-2.0
// Whole scenes: time per pixel, and error against the reference at a smaller size.
#include <algorithm>
#include <bit>
#include <functional>
#include <memory>

#include "backends/reference/backend.h"
#include "runtime/bench/backends.h"
#include "runtime/bench/subject.h"
#include "runtime/render/clock.h"
#include "runtime/render/render.h"
#include "runtime/scene/load.h"
#ifdef ISOSHADE_VULKAN
#include "runtime/bench/forward.h"
#endif

namespace isoshade::bench {

namespace {

using functions::Tier;
using support::Diagnostics;

/// A physically based material, a cartoon with textures and outlines, and fog computed from colour and depth.
constexpr const char* scenes[] = {"material_balls", "cartoon_tub", "fog_balls"};

struct Size {
  int width, height;
};
constexpr Size timed{640, 360};
constexpr Size exact{96, 54};

class SceneBench {
 public:
  SceneBench(const BenchOptions& options, const std::vector<Contestant>& devices, std::deque<render::Plan>& plans,
             Report& report, Diagnostics& diagnostics)
      : options_(options),
        devices_(devices),
        plans_(plans),
        report_(report),
        diagnostics_(diagnostics),
        library_(options.library) {}

  bool run(const std::string& name) {
    const support::Source source =
        graph::read_source(options_.graphs + "/scenes/" + name + ".json", diagnostics_);
    const auto scene =
        source != nullptr ? scene::load_scene(source, {}, library_.files(), diagnostics_) : std::nullopt;
    if (!scene) return false;
    options_.progress("reference of " + name);
    if (!draw_reference(*scene)) return false;
    races_.clear();
    for (const Tier tier : functions::tiers) {
      const render::Plan* small = plan(*scene, exact, tier);
      const render::Plan* large = plan(*scene, timed, tier);
      if (small == nullptr || large == nullptr) return false;
      std::optional<backends::Image> first;
      for (const Contestant& contestant : devices_) {
        if (contestant.built_ins) continue;
        backends::Image image;
        if (!draw(*small, contestant, image)) return false;
        if (!first) first = image;
        Point point{name, "scene", std::string(functions::tier_name(tier)), contestant.backend,
                    contestant.lanes};
        point.identical = bits_of(image) == bits_of(*first);
        enter(std::move(point), image, [this, large, &contestant] {
          backends::Image drawn;
          return draw(*large, contestant, drawn);
        });
      }
      if (tier == Tier::standard && options_.vulkan && !enter_forward(name, *small, *large)) return false;
    }
    options_.progress("timing " + name);
    const int repetitions = std::max(3, options_.repetitions / 4);
    for (int i = 0; i < repetitions; ++i)
      for (Race& race : races_) {
        const auto seconds = race.run();
        if (!seconds) return false;
        race.samples.push_back(*seconds * 1e9 / (timed.width * timed.height));
      }
    for (Race& race : races_) {
      std::ranges::sort(race.samples);
      const size_t n = race.samples.size();
      report_.points[race.point].nanoseconds = race.samples[n / 2];
      report_.points[race.point].spread = race.samples[3 * n / 4] - race.samples[n / 4];
    }
    return true;
  }

 private:
  /// Seconds that drawing took; nothing after an error.
  using Run = std::function<std::optional<double>()>;
  struct Race {
    Run run;
    size_t point;
    std::vector<double> samples = {};
  };

  /// Adds a point, with the errors of its image at the small size, that `run` is to time.
  void enter(Point point, const backends::Image& image, Run run) {
    const Errors errors = errors_of(bits_of(image), reference_);
    point.max_ulp = errors.max_ulp;
    point.mean_ulp = errors.mean_ulp;
    point.max_absolute = errors.max_absolute;
    races_.push_back({std::move(run), report_.points.size()});
    report_.points.push_back(std::move(point));
  }

#ifdef ISOSHADE_VULKAN
  /// Adds the point of an ordinary renderer on the same device.
  bool enter_forward(const std::string& name, const render::Plan& small, const render::Plan& large) {
    if (const std::string lack = forward_lack(small); !lack.empty()) {
      report_.notes.push_back("no forward renderer of " + name + ": it has " + lack);
      return true;
    }
    const auto peer_of = [&](const render::Plan& plan) -> std::shared_ptr<ForwardPeer> {
      return ForwardPeer::make(plan, options_.graphs, options_.device, library_, diagnostics_);
    };
    const auto compared = peer_of(small), raced = peer_of(large);
    backends::Image image;
    // The first frame of the large one compiles what the driver puts off until then.
    if (!compared || !raced || !compared->renderer->draw(diagnostics_) || !compared->renderer->read(image, diagnostics_) ||
        !raced->renderer->draw(diagnostics_))
      return false;
    enter({name, "scene", "built-ins", forward_backend, ""}, image, [this, raced]() -> std::optional<double> {
      render::Clock clock;
      if (!raced->renderer->draw(diagnostics_)) return std::nullopt;
      return clock.lap();
    });
    return true;
  }
#else
  static bool enter_forward(const std::string&, const render::Plan&, const render::Plan&) { return true; }
#endif

  const render::Plan* plan(const scene::Scene& scene, Size size, Tier tier, bool reference = false) {
    render::PlanOptions options;
    options.width = size.width;
    options.height = size.height;
    options.compiler.library = &library_;
    options.compiler.tier = tier;
    options.compiler.reference = reference;
    auto made = render::plan_frame(scene, options, diagnostics_);
    return made ? &plans_.emplace_back(*std::move(made)) : nullptr;
  }

  /// Returns the time that all steps of a frame took, from its vertices to its posts, in seconds.
  std::optional<double> draw(const render::Plan& plan, const Contestant& contestant, backends::Image& image) {
    render::DrawStats stats;
    if (!render::render(plan, *contestant.device, image, stats, diagnostics_)) return std::nullopt;
    return stats.transform_seconds + stats.clip_seconds + stats.draw_seconds + stats.post_seconds;
  }

  bool draw_reference(const scene::Scene& scene) {
    const render::Plan* made = plan(scene, exact, Tier::standard, true);
    backends::Image image;
    render::DrawStats stats;
    const auto backend = reference::create();
    if (made == nullptr || !render::render(*made, *backend, image, stats, diagnostics_)) return false;
    reference_.assign(image.rgba.begin(), image.rgba.end());
    return true;
  }

  static std::vector<int32_t> bits_of(const backends::Image& image) {
    std::vector<int32_t> bits;
    for (const float value : image.rgba) bits.push_back(std::bit_cast<int32_t>(value));
    return bits;
  }

  const BenchOptions& options_;
  const std::vector<Contestant>& devices_;
  std::deque<render::Plan>& plans_;
  Report& report_;
  Diagnostics& diagnostics_;
  check::Library library_;
  std::vector<reference::Real> reference_;
  std::vector<Race> races_;
};

}  // namespace

bool measure_scenes(const BenchOptions& options, const std::vector<Contestant>& devices,
                    std::deque<render::Plan>& plans, Report& report, Diagnostics& diagnostics) {
  for (const char* name : scenes) {
    if (std::string_view(name).find(options.filter) == std::string_view::npos) continue;
    if (!SceneBench(options, devices, plans, report, diagnostics).run(name)) return false;
  }
  return true;
}

}  // namespace isoshade::bench
