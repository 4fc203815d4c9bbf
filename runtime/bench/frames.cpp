// SPDX-License-Identifier: Apache-2.0
#include "runtime/bench/frames.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <thread>

#include "backends/cpu/backend.h"
#include "runtime/render/clock.h"
#include "runtime/render/render.h"
#include "runtime/scene/load.h"
#ifdef ISOSHADE_VULKAN
#include "backends/vulkan/backend.h"
#endif

namespace isoshade::bench {

namespace {

using support::Diagnostics;

/// A backend that keeps its memory and programs from frame to frame.
struct Drawer {
  std::string name;
  int threads;
  std::unique_ptr<backends::Backend> backend;
  std::unique_ptr<render::Renderer> renderer;
};

/// A scene as a document and how many times the triangles of its mesh are cut into four.
struct Subject {
  std::string name;
  support::Source source;
};

constexpr int first_subdivisions = 3, last_subdivisions = 8;  // 1,280 to 1,310,720 triangles

/// One ball that fills the frame, which is lit as those of material_balls are.
support::Source mesh_scene(const std::string& graphs, int subdivisions) {
  return std::make_shared<support::SourceFile>(graphs + "/scenes/mesh.json", R"({
  "isoshade": 1,
  "scene": "mesh",
  "size": [1024, 1024],
  "camera": {"position": [0, 0, 20], "target": [0, 0, 0], "fov": 5.8, "near": 1},
  "lights": {"sun": {"type": "directional", "direction": [0.6, -0.7, -0.7], "intensity": 2.6}},
  "objects": {"ball": {
    "mesh": {"type": "icosphere", "subdivisions": )" + std::to_string(subdivisions) + R"(},
    "effect": "../materials/cook_torrance.json"
  }}
})");
}

class FrameBench {
 public:
  FrameBench(const FrameBenchOptions& options, Diagnostics& diagnostics)
      : options_(options), diagnostics_(diagnostics), library_(options.common.library) {
    if (options_.sizes.empty()) options_.sizes = {256, 512, 1024, 2048, 4096};
    if (options_.threads.empty()) {
      const int all = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
      for (int count = 1; count < all; count *= 2) options_.threads.push_back(count);
      options_.threads.push_back(all);
    }
  }

  std::optional<FrameReport> run() {
    if (!open()) return std::nullopt;
    const auto subjects = find_subjects();
    if (!subjects) return std::nullopt;
    for (const Subject& subject : *subjects)
      if (!measure(subject)) return std::nullopt;
    return std::move(report_);
  }

 private:
  bool open() {
    const BenchOptions& common = options_.common;
    for (const int threads : options_.threads) {
      cpu::CpuOptions cpu;
      cpu.lanes = common.lanes.empty() ? "" : common.lanes.back();
      cpu.threads = threads;
      cpu.compiler = common.compiler;
      cpu.build_timeout = common.build_timeout;
      if (!add("cpu", threads, cpu::create(cpu, diagnostics_))) return false;
    }
#ifdef ISOSHADE_VULKAN
    if (common.vulkan) {
      vulkan::VulkanOptions vulkan;
      vulkan.device = common.device;
      auto device = vulkan::create(vulkan, diagnostics_);
      const int threads = device != nullptr ? device->workers().count() : 0;
      if (!add("vulkan", threads, std::move(device))) return false;
    }
#endif
    return true;
  }

  bool add(std::string name, int threads, std::unique_ptr<backends::Backend> backend) {
    if (backend == nullptr) return false;
    report_.machines.push_back(backend->description());
    auto renderer = std::make_unique<render::Renderer>(*backend);
    drawers_.push_back({std::move(name), threads, std::move(backend), std::move(renderer)});
    return true;
  }

  std::optional<std::vector<Subject>> find_subjects() {
    const std::string &graphs = options_.common.graphs, &filter = options_.common.filter;
    std::vector<std::string> names;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(graphs + "/scenes", error))
      if (entry.path().extension() == ".json" && entry.path().stem().string().find(filter) != std::string::npos)
        names.push_back(entry.path().stem().string());
    std::ranges::sort(names);
    std::vector<Subject> subjects;
    for (const std::string& name : names) {
      subjects.push_back({name, graph::read_source(graphs + "/scenes/" + name + ".json", diagnostics_)});
      if (subjects.back().source == nullptr) return std::nullopt;
    }
    if (std::string_view("mesh").find(filter) != std::string_view::npos)
      for (int count = first_subdivisions; count <= last_subdivisions; ++count)
        subjects.push_back({"mesh", mesh_scene(graphs, count)});
    return subjects;
  }

  std::optional<render::Plan> plan(const scene::Scene& scene, int size) {
    render::PlanOptions options;
    options.width = options.height = size;
    options.compiler.library = &library_;
    return render::plan_frame(scene, options, diagnostics_);
  }

  struct Samples {
    std::vector<double> plan, vertices, clip, draw, posts, whole;
  };

  /// Draws one frame, and plans it anew, as for a frame in which something has moved. The first frame of a drawer at a
  /// size is not counted.
  bool frame(const scene::Scene& scene, int size, Drawer& drawer, Samples* samples, double& triangles,
             Diagnostics& diagnostics) {
    const auto made = plan(scene, size);
    if (!made) return false;
    render::DrawStats stats;
    if (!drawer.renderer->draw(*made, stats, diagnostics)) return false;
    triangles = static_cast<double>(made->stats.triangles);
    if (samples == nullptr) return true;
    samples->plan.push_back(made->stats.plan_seconds);
    samples->vertices.push_back(stats.transform_seconds);
    samples->clip.push_back(stats.clip_seconds);
    samples->draw.push_back(stats.draw_seconds);
    samples->posts.push_back(stats.post_seconds);
    samples->whole.push_back(made->stats.plan_seconds + stats.transform_seconds + stats.clip_seconds +
                             stats.draw_seconds + stats.post_seconds);
    return true;
  }

  bool measure(const Subject& subject) {
    const auto scene = scene::load_scene(subject.source, {}, library_.files(), diagnostics_);
    if (!scene) return false;
    // The triangles are varied at one size, which is that of the others' comparison.
    const std::vector<int> sizes = subject.name == "mesh" ? std::vector{reference_size()} : options_.sizes;
    struct Race {
      int size;
      Drawer* drawer;
      Samples samples = {};
      double triangles = 0;
    };
    std::vector<Race> races;
    for (const int size : sizes)
      for (Drawer& drawer : drawers_) races.push_back({size, &drawer});
    options_.common.progress("frames of " + subject.name);
    const auto is_too_large = [](const support::Diagnostic& report) { return report.id == support::Id::device_limit; };
    std::erase_if(races, [&](Race& race) {
      Diagnostics reports;
      // Another failure comes again, and is reported then.
      if (frame(*scene, race.size, *race.drawer, nullptr, race.triangles, reports) ||
          std::ranges::none_of(reports.all(), is_too_large))
        return false;
      options_.common.progress("no frame of " + std::to_string(race.size) + " pixels a side: too large for " +
                               race.drawer->name);
      return true;
    });
    for (int i = 0; i < options_.common.repetitions; ++i)
      for (Race& race : races)
        if (!frame(*scene, race.size, *race.drawer, &race.samples, race.triangles, diagnostics_)) return false;
    for (Race& race : races) {
      const auto quantile = [](std::vector<double>& samples, double q) {
        std::ranges::sort(samples);
        return samples[static_cast<size_t>(q * static_cast<double>(samples.size() - 1) + 0.5)];
      };
      Samples& s = race.samples;
      report_.points.push_back({subject.name, race.size, race.drawer->name, race.drawer->threads, race.triangles,
                                quantile(s.plan, 0.5), quantile(s.vertices, 0.5), quantile(s.clip, 0.5),
                                quantile(s.draw, 0.5), quantile(s.posts, 0.5), quantile(s.whole, 0.5),
                                quantile(s.whole, 0.75) - quantile(s.whole, 0.25)});
    }
    return true;
  }

  /// 1024, or the last size that is measured.
  int reference_size() const {
    const bool has = std::ranges::find(options_.sizes, 1024) != options_.sizes.end();
    return has ? 1024 : options_.sizes.back();
  }

  FrameBenchOptions options_;
  Diagnostics& diagnostics_;
  check::Library library_;
  std::vector<Drawer> drawers_;
  FrameReport report_;
};

}  // namespace

std::optional<FrameReport> measure_frames(const FrameBenchOptions& options, Diagnostics& diagnostics) {
  return FrameBench(options, diagnostics).run();
}

}  // namespace isoshade::bench
