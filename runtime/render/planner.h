// SPDX-License-Identifier: Apache-2.0
// How a plan is made, for the files of this folder that make it: plan.cpp compiles and collects, plan_draws.cpp places.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "runtime/render/parameters.h"
#include "runtime/render/plan.h"
#include "runtime/render/records.h"
#include "runtime/render/shadows.h"
#include "runtime/render/skips.h"
#include "runtime/render/textures.h"

namespace isoshade::render {

class Planner {
 public:
  Planner(const scene::Scene& scene, const PlanOptions& options, support::Diagnostics& diagnostics)
      : scene_(scene),
        options_(options),
        diagnostics_(diagnostics),
        textures_(options.compiler.library != nullptr ? &options.compiler.library->files() : nullptr) {}

  std::optional<Plan> plan();

 private:
  struct PassPrograms {
    uint32_t vertex, pixel, blend;  // in Frame::programs
  };

  bool compile_effects();
  bool compile_posts();
  /// What the programs are compiled for.
  driver::CompileOptions compile_options() const;
  /// Adds the maps of the environment to the textures; its first record, or -1 without one. Nothing after an error.
  std::optional<int> add_environment();
  support::Source read_document(const std::string& path, const support::Span& where);
  /// `cutout`: of a pixel program, the index of the one that belongs to it.
  uint32_t add_program(const driver::Program& program, uint32_t cutout = backends::Frame::no_program);
  bool may_read(const std::string& path, const support::Span& where);
  bool make_objects();
  std::optional<size_t> find_mesh(const scene::Object& object);
  void note_largest_mesh(const scene::Object& object, const StoredMesh& mesh);
  std::optional<std::vector<ParameterValues>> resolve_parts(const scene::Object& object, const driver::Effect& effect,
                                                            const StoredMesh& mesh, const FindTexture& find_texture);
  int64_t most_draws(const driver::Effect& effect, const ParameterValues& values) const;
  void place_object(size_t o);
  /// Adds a view. The camera and the size of a pixel are those of an image of this size.
  void add_view(const scene::Camera& camera, const scene::View& view, int width, int height, backends::Target target);
  /// Adds the records of the lights, and a view for each of their shadow maps.
  void add_lights(const scene::View& picture);
  void note_largest_shadow(const scene::Light& light, size_t maps);
  std::vector<Hull> find_hulls(const scene::View& picture) const;
  bool is_shadow_map(size_t view) const { return view < shadow_maps_; }
  /// The number of the view that draws what is opaque alone, if there is one.
  size_t opaque_view() const { return shadow_maps_; }
  /// One copy of an object in one view.
  struct Appearance {
    glm::mat4 projected;
    bool outside;     ///< of the view: passes that do not move vertices draw nothing
    float nearness;   ///< of the middle of its mesh's bounds: greater the nearer it is
    int matrix = -1;  ///< the first word of `projected` in View::words, once a draw needs it
  };
  /// One copy of an object.
  struct Copy {
    scene::Instance instance;
    ObjectTransforms place;
    std::span<Appearance> views;  ///< one for each view
  };
  void place_copy(size_t o, const Copy& copy, std::vector<PassSkips>& skipped);
  /// Places one pass over a copy, one repetition after the other. `parameters`: of each part.
  void place_pass(size_t o, size_t pass, const Copy& copy, std::span<const std::vector<float>> parameters, PassSkips& skipped);
  /// How often a pass is drawn over a part: of a plan for programs that change parameters, as often as it may be.
  int repetitions_of(const driver::Effect& effect, const driver::EffectPass& pass, std::span<const float> parameters) const;
  /// Appends the record of a draw.
  backends::Draw make_draw(const ObjectTransforms& place, const PassPrograms& programs, const MeshPart& part,
                           Repetition repetition, const std::vector<float>& parameters);
  /// Adds the draw to a view, or to `blended_`.
  void place_draw(backends::Draw draw, Appearance& appearance, size_t view);
  void add_views(int width, int height, int side);
  /// Adds the draws that are blended to each view, behind all others.
  void append_blended();

  // How far things have moved (plan_motion.cpp), if a post reads that.
  /// The same object at the frame before.
  const scene::Object& before(size_t o) const { return before_.objects.empty() ? scene_.objects[o] : before_.objects[o]; }
  void begin_motion(int width, int height);
  /// A program that draws motion, with the cut-out of a pixel program.
  uint32_t motion_program(uint32_t pixel);
  /// Adds a draw of the picture to both views.
  void place_motion(size_t o, const Copy& copy, size_t part, const backends::Draw& draw, const Appearance& appearance);
  void finish_motion();

  const scene::Scene& scene_;
  const PlanOptions& options_;
  support::Diagnostics& diagnostics_;
  Plan plan_;
  std::vector<scene::View> cameras_;  ///< of each view of the frame
  size_t shadow_maps_ = 0;            ///< the views that begin the frame
  uint64_t shadow_texels_ = 0, most_shadow_texels_ = 0;  ///< of all shadow maps; of those of one light
  bool has_opaque_view_ = false;
  struct BlendedDraw {
    float nearness;
    backends::Draw draw;
  };
  std::vector<std::vector<BlendedDraw>> blended_;  ///< of each view, in the order of the scene
  std::vector<size_t> effect_of_object_;
  std::vector<std::vector<PassPrograms>> programs_of_effect_;
  std::map<std::string, uint32_t> program_by_text_;
  std::vector<std::vector<ParameterValues>> parameters_;  ///< of each object, for each part of its mesh
  scene::Scene before_;                                   ///< the frame before; without objects if none has changed
  std::vector<std::vector<ParameterValues>> parameters_before_;  ///< empty if none has changed
  struct MovedDraw {
    float nearness;  ///< of what is blended; the rest is drawn first
    backends::Draw now, before;
  };
  std::vector<MovedDraw> moved_, moved_blended_;
  glm::mat4 projection_before_{1};
  std::map<uint32_t, uint32_t> motion_programs_;  ///< by the program of the cut-out
  MeshStore meshes_;
  uint32_t most_vertices_ = 0;  ///< of a mesh
  std::vector<size_t> mesh_of_object_;
  TextureStore textures_;
  std::vector<const driver::Post*> posts_;  ///< of each post of the scene
};

}  // namespace isoshade::render
