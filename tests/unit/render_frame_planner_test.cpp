// SPDX-License-Identifier: Apache-2.0
// Plans that are made from the one before are those that are made anew, and keep the revisions of what stays.
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

#include "compiler/driver/driver.h"
#include "compiler/ir/printer.h"
#include "runtime/lanes/float_rules.h"
#include "runtime/render/plan.h"
#include "runtime/scene/image_file.h"
#include "runtime/scene/load.h"
#include "runtime/scene/placement.h"
#include "tests/unit/scene_documents.h"

namespace isoshade {
namespace {

namespace fs = std::filesystem;

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

/// Where a program is the same, whatever its address.
std::string text_of(const driver::Program& program) {
  return std::to_string(static_cast<int>(program.stage)) + " " + std::to_string(program.entry) + "\n" +
         ir::print(program.module);
}

void expect_same(const backends::View& a, const backends::View& b, const std::string& what) {
  EXPECT_EQ(a.target, b.target) << what;
  EXPECT_TRUE(same_bits(a.words, b.words)) << what;
  EXPECT_TRUE(same_bits(a.frame, b.frame)) << what;
  EXPECT_EQ(a.reads, b.reads) << what;
  EXPECT_EQ(std::memcmp(a.background, b.background, sizeof a.background), 0) << what;
  EXPECT_EQ(std::memcmp(&a.depth_bias, &b.depth_bias, sizeof a.depth_bias), 0) << what;
  ASSERT_EQ(a.draws.size(), b.draws.size()) << what;
  for (size_t i = 0; i < a.draws.size(); ++i) {
    const backends::Draw &x = a.draws[i], &y = b.draws[i];
    const bool same = x.vertex_program == y.vertex_program && x.pixel_program == y.pixel_program &&
                      x.object == y.object && x.projected == y.projected && x.first_vertex == y.first_vertex &&
                      x.vertex_count == y.vertex_count && std::ranges::equal(x.indices, y.indices) &&
                      x.state == y.state && x.mirrored == y.mirrored && x.cutout == y.cutout && x.blended == y.blended;
    ASSERT_TRUE(same) << what << ", draw " << i;
  }
}

void expect_same(const render::Plan& a, const render::Plan& b, const std::string& what) {
  const backends::Frame &x = a.frame, &y = b.frame;
  EXPECT_TRUE(same_bits(x.vertices, y.vertices)) << what;
  EXPECT_TRUE(same_bits(x.objects, y.objects)) << what;
  EXPECT_TRUE(same_bits(x.lights, y.lights)) << what;
  EXPECT_TRUE(same_bits(x.frame, y.frame)) << what;
  EXPECT_TRUE(same_bits(x.texels, y.texels)) << what;
  EXPECT_TRUE(same_bits(x.texel_bytes, y.texel_bytes)) << what;
  EXPECT_TRUE(same_bits(x.textures, y.textures)) << what;
  EXPECT_EQ(x.cutouts, y.cutouts) << what;
  EXPECT_EQ(x.light_count, y.light_count) << what;
  for (const auto member : {&backends::Frame::largest_in_texels, &backends::Frame::largest_in_texel_bytes,
                            &backends::Frame::largest_mesh, &backends::Frame::largest_shadow})
    EXPECT_EQ((x.*member).what, (y.*member).what) << what;
  ASSERT_EQ(x.programs.size(), y.programs.size()) << what;
  for (size_t i = 0; i < x.programs.size(); ++i) EXPECT_EQ(text_of(*x.programs[i]), text_of(*y.programs[i])) << what;
  ASSERT_EQ(x.views.size(), y.views.size()) << what;
  for (size_t v = 0; v < x.views.size(); ++v) expect_same(x.views[v], y.views[v], what + ", view " + std::to_string(v));

  EXPECT_EQ(a.samples, b.samples) << what;
  ASSERT_EQ(a.origins.size(), b.origins.size()) << what;
  for (size_t i = 0; i < a.origins.size(); ++i) {
    EXPECT_EQ(a.origins[i].record, b.origins[i].record) << what;
    EXPECT_EQ(a.origins[i].object, b.origins[i].object) << what;
    EXPECT_EQ(a.origins[i].pass->name, b.origins[i].pass->name) << what;
  }
  ASSERT_EQ(a.motion.has_value(), b.motion.has_value()) << what;
  if (a.motion) {
    expect_same(a.motion->before, b.motion->before, what + ", before");
    expect_same(a.motion->now, b.motion->now, what + ", motion");
    EXPECT_TRUE(same_bits(a.motion->backdrop, b.motion->backdrop)) << what;
  }
  ASSERT_EQ(a.posts.steps.size(), b.posts.steps.size()) << what;
  for (size_t i = 0; i < a.posts.steps.size(); ++i) {
    const render::PostStep &s = a.posts.steps[i], &t = b.posts.steps[i];
    EXPECT_EQ(text_of(s.post->program), text_of(t.post->program)) << what;
    EXPECT_TRUE(same_bits(s.record, t.record)) << what;
    EXPECT_TRUE(s.width == t.width && s.height == t.height && s.sources == t.sources) << what;
  }
  EXPECT_EQ(a.posts.last_reader, b.posts.last_reader) << what;
  EXPECT_EQ(a.posts.result, b.posts.result) << what;
  EXPECT_EQ(a.posts.sample_steps, b.posts.sample_steps) << what;
  const auto counts = [](const render::PlanStats& s) {
    return std::vector<int64_t>{s.copies, s.draws,   s.repetitions, s.repeated, s.vertices, s.triangles,     s.meshes, s.mesh_vertices,
                                s.effects, s.programs, s.textures,  s.texels,   s.texture_bytes, s.lights, s.posts,  s.sample_posts};
  };
  EXPECT_EQ(counts(a.stats), counts(b.stats)) << what;
  ASSERT_EQ(a.stats.skips.size(), b.stats.skips.size()) << what;
  for (size_t i = 0; i < a.stats.skips.size(); ++i) {
    EXPECT_EQ(a.stats.skips[i].what, b.stats.skips[i].what) << what;
    EXPECT_EQ(a.stats.skips[i].reason, b.stats.skips[i].reason) << what;
  }
}

class FramePlanner : public ::testing::Test {
 protected:
  render::PlanOptions options(int width = 0, int height = 0) {
    render::PlanOptions options;
    options.compiler.library = &library_;
    options.width = width;
    options.height = height;
    return options;
  }
  /// Plans a scene by the planner and anew, and compares.
  const render::Plan* expect_same_as_anew(render::FramePlanner& planner, const scene::Scene& scene,
                                          const render::PlanOptions& options, const std::string& what) {
    const render::Plan* kept = planner.plan(scene, diagnostics_);
    const auto anew = render::plan_frame(scene, options, diagnostics_);
    EXPECT_TRUE(kept != nullptr && anew) << what << "\n" << diagnostics_.text();
    if (kept != nullptr && anew) expect_same(*kept, *anew, what);
    return kept;
  }
  /// Whether records may depend on the time.
  static bool may_draw_by_time(const render::Plan& plan) {
    const auto reads = [](const driver::Program& program) {
      return std::ranges::any_of(program.bindings, [](const interface::Binding& binding) {
        return std::holds_alternative<interface::source::Time>(binding.source);
      });
    };
    return std::ranges::any_of(plan.effects, [&](const driver::Effect& effect) {
      return std::ranges::any_of(effect.passes, [&](const driver::EffectPass& pass) {
        return reads(pass.vertex) || reads(pass.pixel) || (pass.cutout && reads(*pass.cutout));
      });
    });
  }
  static scene::Scene turned(scene::Scene scene, int part, int whole) {
    const lanes::FpGuard guard;
    if (scene.before == nullptr) scene.before = std::make_shared<scene::Scene>(scene);
    scene.camera = scene::turned(scene.camera, part, whole);
    scene.before->camera = scene::turned(scene.before->camera, part - 1, whole);
    return scene;
  }

  check::Library library_{check::shipped_library()};
  support::Diagnostics diagnostics_;
};

TEST_F(FramePlanner, PlansEveryShippedSceneOnATurntableAndInTimeAsIfAnew) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(ISOSHADE_GRAPHS) / "scenes")) {
    if (entry.path().extension() != ".json") continue;
    const std::string path = entry.path().string();
    const auto document = scene::SceneDocument::load(graph::read_source(path, diagnostics_), {}, library_.files(), diagnostics_);
    ASSERT_TRUE(document) << diagnostics_.text();
    const render::PlanOptions small = options(96, 64);
    render::FramePlanner planner(small);
    backends::Revisions first;
    for (int i = 0; i < 3; ++i) {
      auto scene = document->at(0.4f * static_cast<float>(i / 2), diagnostics_);
      ASSERT_TRUE(scene) << diagnostics_.text();
      const std::string what = path + ", frame " + std::to_string(i);
      const render::Plan* plan = expect_same_as_anew(planner, i == 2 ? *scene : turned(*scene, i + 1, 5), small, what);
      ASSERT_NE(plan, nullptr);
      const backends::Revisions& now = plan->frame.revisions;
      if (i == 0) first = now;
      EXPECT_TRUE(now.programs == first.programs && now.vertices == first.vertices && now.texels == first.texels &&
                  now.texel_bytes == first.texel_bytes && now.textures == first.textures)
          << what;
      if (i < 2 || !(document->is_animated() || may_draw_by_time(*plan))) {
        EXPECT_EQ(now.objects, first.objects) << what;
      }
    }
    ++count;
  }
  EXPECT_GT(count, 20);
}

/// A scene whose parts can be changed one by one.
class ChangedScene : public FramePlanner {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) / ("isoshade_frames" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    write("shown.json", R"({"isoshade": 1, "effect": "shown",
      "parameters": {"map": {"type": "filename", "value": "a.png"}, "tint": {"type": "color3", "value": [1, 1, 1]},
                     "second": {"type": "boolean", "value": true}},
      "nodes": {"uv": {"type": "texcoord"}, "picture": {"type": "image", "file": {"link": "map"}, "texcoord": "uv"},
                "t": {"type": "time"}, "tinted": {"type": "multiply", "in1": "picture", "in2": "tint"},
                "color": {"type": "multiply", "in1": "tinted", "in2": "t"}},
      "passes": [{"name": "base", "color": "color"}, {"name": "again", "enabled": "second", "color": "tint"}]})");
    for (const char* name : {"a.png", "b.png"}) {
      std::vector<uint8_t> bytes(4 * 16, name[0] == 'a' ? 90 : 200);
      write(name, scene::png(4, 4, bytes));
    }
    source_ = std::make_shared<support::SourceFile>((folder_ / "scene.json").string(), testing::scene_text(R"(
      "lights": {"sun": {"type": "directional", "direction": [0.3, -1, -0.2], "shadow": {"size": 64}},
                 "lamp": {"type": "point", "position": [0, 2, 1]}},
      "environment": {"sky": {"horizon": [0.5, 0.6, 0.7], "zenith": [0.1, 0.2, 0.4], "ground": [0.1, 0.1, 0.1]}},
      "objects": {
        "floor": {"mesh": {"type": "plane", "size": [6, 6]}, "effect": "shown.json", "parameters": {"map": "b.png"}},
        "ball": {"mesh": {"type": "sphere", "radius": 0.5}, "effect": "shown.json",
                 "transform": {"translate": [0, 0.5, 0]}},
        "posts": {"mesh": {"type": "cylinder", "radius": 0.1, "height": 1}, "effect": "shown.json",
                  "repeat": [{"count": 40, "step": [0.3, 0, 0], "parameters": {"tint": {"from": [1, 0, 0], "to": [0, 0, 1]}}},
                             {"count": 3, "step": [0, 0, -0.4]}]}})"));
  }
  void TearDown() override { fs::remove_all(folder_); }
  void write(const std::string& name, const std::string& bytes) const { std::ofstream(folder_ / name) << bytes; }
  scene::Scene load(const std::vector<std::string>& settings) {
    auto scene = scene::load_scene(source_, settings, library_.files(), diagnostics_);
    EXPECT_TRUE(scene) << diagnostics_.text();
    return *scene;
  }

  fs::path folder_;
  support::Source source_;
};

TEST_F(ChangedScene, IsPlannedAsIfAnewWhateverChanges) {
  render::PlanOptions small = options(64, 48);
  small.compiler.skips.set(interface::Skip::parameters, false);  // one more reason to begin anew
  render::FramePlanner planner(small);
  using Arrays = std::vector<uint64_t backends::Revisions::*>;
  using R = backends::Revisions;
  struct Change {
    std::string setting;
    Arrays changed;  ///< which arrays then differ
  };
  const render::Plan* plan = expect_same_as_anew(planner, load({}), small, "the scene");
  ASSERT_NE(plan, nullptr);
  const Arrays all{&R::programs, &R::vertices, &R::objects, &R::lights, &R::frame, &R::texels, &R::texel_bytes, &R::textures};
  for (const auto array : all) EXPECT_NE(plan->frame.revisions.*array, 0u);
  const std::vector<Change> changes = {
      {"camera.position=1,2,5", {}},
      {"camera.fov=20", {}},
      {"time=3", {&R::frame}},
      {"sun.direction=0.1,-1,0.1", {&R::lights}},
      {"lamp.position=1,2,1", {&R::lights}},
      {"environment.rotate=30", {&R::texels, &R::textures}},
      {"ball.tint=0,1,0", {&R::objects}},
      {"ball.second=false", {&R::objects}},
      {"posts.second=false", {&R::objects}},
  };
  for (const Change& change : changes) {
    for (const bool back : {false, true}) {
      const R before = plan->frame.revisions;
      plan = expect_same_as_anew(planner, load(back ? std::vector<std::string>{} : std::vector{change.setting}), small,
                                 change.setting + (back ? ", and back" : ""));
      ASSERT_NE(plan, nullptr);
      for (const auto array : all) {
        const bool differs = std::ranges::find(change.changed, array) != change.changed.end();
        EXPECT_EQ(plan->frame.revisions.*array != before.*array, differs) << change.setting;
      }
    }
  }
}

TEST_F(ChangedScene, IsPlannedAsIfAnewWithOtherMeshesAndPlaces) {
  const render::PlanOptions small = options(64, 48);
  render::FramePlanner planner(small);
  ASSERT_NE(planner.plan(load({}), diagnostics_), nullptr);
  const auto expect = [&](const std::string& what, auto change) {
    scene::Scene scene = load({});
    change(scene);
    expect_same_as_anew(planner, scene, small, what);
    expect_same_as_anew(planner, load({}), small, what + ", and back");
  };
  expect("another radius", [](scene::Scene& s) { s.objects[1].mesh.size = glm::vec3(0.7f); });
  expect("a mesh that another object has", [](scene::Scene& s) { s.objects[1].mesh = s.objects[2].mesh; });
  expect("meshes the other way round", [](scene::Scene& s) { std::swap(s.objects[0].mesh, s.objects[2].mesh); });
  expect("another place", [](scene::Scene& s) { s.objects[1].transform.translate.x = 1; });
  expect("the other zero", [](scene::Scene& s) { s.objects[1].transform.translate.x = -0.0f; });
  expect("another step", [](scene::Scene& s) { s.objects[2].repeat[0].step.x = 0.1f; });
  expect("fewer copies", [](scene::Scene& s) { s.objects[2].repeat[1].count = 2; });
  expect("no shadow of the ball", [](scene::Scene& s) { s.objects[1].casts_shadow = false; });
  expect("no shadow on the floor", [](scene::Scene& s) { s.objects[0].receives_shadow = false; });
  expect("one object less", [](scene::Scene& s) { s.objects.erase(s.objects.begin()); });
  expect("no light", [](scene::Scene& s) { s.lights.clear(); });
  expect("no environment", [](scene::Scene& s) { s.environment.reset(); });
  expect("four samples", [](scene::Scene& s) { s.samples = 4; });
  expect("another image", [](scene::Scene& s) { s.objects[1].parameters = s.objects[0].parameters; });
  expect("images in another order", [](scene::Scene& s) { std::swap(s.objects[0].parameters, s.objects[1].parameters); });
}

TEST_F(ChangedScene, IsCompiledAnewOnceForEachFixedParameterThatChanges) {
  const render::PlanOptions small = options(64, 48);
  render::FramePlanner planner(small);
  const render::Plan* plan = planner.plan(load({}), diagnostics_);
  ASSERT_NE(plan, nullptr) << diagnostics_.text();
  const auto is_fixed = [&](const char* name) {
    return std::ranges::all_of(plan->effects, [&](const driver::Effect& effect) {
      return driver::is_fixed(effect.fixed, effect.parameters, *effect.parameters.find(name));
    });
  };
  EXPECT_TRUE(is_fixed("second"));
  EXPECT_FALSE(is_fixed("tint")) << "it varies along a grid";
  const uint64_t first = plan->frame.revisions.programs;
  plan = planner.plan(turned(load({}), 1, 5), diagnostics_);
  EXPECT_EQ(plan->frame.revisions.programs, first) << "a turntable compiles nothing";

  plan = planner.plan(load({"ball.second=false"}), diagnostics_);
  ASSERT_NE(plan, nullptr) << diagnostics_.text();
  EXPECT_NE(plan->frame.revisions.programs, first);
  EXPECT_FALSE(is_fixed("second"));
  const uint64_t second = plan->frame.revisions.programs;
  for (const char* setting : {"ball.second=true", "floor.second=false", "ball.second=false"}) {
    plan = planner.plan(load({setting}), diagnostics_);
    ASSERT_NE(plan, nullptr) << diagnostics_.text();
    EXPECT_EQ(plan->frame.revisions.programs, second) << setting;
  }
}

TEST_F(ChangedScene, ThatCannotBePlannedIsReportedOnceAndThenForgotten) {
  const render::PlanOptions small = options(64, 48);
  render::FramePlanner planner(small);
  ASSERT_NE(planner.plan(load({}), diagnostics_), nullptr);
  scene::Scene wrong = load({});
  wrong.objects[1].parameters.push_back({"tnit", {}, {}, {}});
  support::Diagnostics reports;
  EXPECT_EQ(planner.plan(wrong, reports), nullptr);
  ASSERT_EQ(reports.all().size(), 1u);
  EXPECT_NE(reports.text().find("has no parameter \"tnit\""), std::string::npos) << reports.text();
  expect_same_as_anew(planner, load({}), small, "after an error");
}

TEST_F(ChangedScene, GivesTheSamePlanOnOneThreadAndOnMany) {
  threads::Workers one(1), many(5);
  render::PlanOptions alone = options(64, 48), together = alone;
  alone.workers = &one;
  together.workers = &many;
  const auto a = render::plan_frame(load({}), alone, diagnostics_), b = render::plan_frame(load({}), together, diagnostics_);
  ASSERT_TRUE(a && b) << diagnostics_.text();
  expect_same(*a, *b, "threads");
}

TEST_F(ChangedScene, KeepsTheRevisionsOfViewsThatStay) {
  const render::PlanOptions small = options(64, 48);
  render::FramePlanner planner(small);
  const auto revisions = [&](const scene::Scene& scene) {
    std::vector<uint64_t> of_views;
    for (const backends::View& view : planner.plan(scene, diagnostics_)->frame.views) of_views.push_back(view.revision);
    return of_views;
  };
  const std::vector<uint64_t> first = revisions(load({}));
  EXPECT_EQ(revisions(load({})), first);
  EXPECT_NE(revisions(load({"camera.fov=20"})).back(), first.back());
}

}  // namespace
}  // namespace isoshade
