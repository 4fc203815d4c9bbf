// SPDX-License-Identifier: Apache-2.0
// How a plan is made, for the files of this folder that make it: plan.cpp compiles and collects, plan_place.cpp writes
// the records of all copies, plan_compile.cpp makes the programs, plan_views.cpp lists what each view draws,
// plan_images.cpp finds which images they read, plan_lights.cpp places the shadow maps, plan_light_lists.cpp lists the lights of each copy.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "runtime/render/compiled.h"
#include "runtime/render/draw_evaluator.h"
#include "runtime/render/fixed_values.h"
#include "runtime/render/parameters.h"
#include "runtime/render/plan.h"
#include "runtime/render/plan_keys.h"
#include "runtime/render/records.h"
#include "runtime/render/shadows.h"
#include "runtime/render/skips.h"
#include "runtime/render/textures.h"

namespace isoshade::render {

class Planner {
 public:
  Planner(const PlanOptions& options, threads::Workers& workers, Compiled& compiled)
      : options_(options),
        workers_(workers),
        compiled_(compiled),
        textures_(options.compiler.library != nullptr ? &options.compiler.library->files() : nullptr, workers),
        meshes_(plan_.meshes, plan_.frame.vertices, workers) {}

  /// Plans a scene; false after an error, and then the planner is of no further use.
  bool plan(const scene::Scene& scene, support::Diagnostics& diagnostics);
  /// Plans the next scene and keeps what stays. False, perhaps with diagnostics, if another planner must begin anew.
  bool plan_next(const scene::Scene& scene, support::Diagnostics& diagnostics);
  Plan& made() { return plan_; }
  /// The parameters whose values the next scene changed although programs were compiled for them.
  const std::set<std::string>& changed() const { return changed_; }

 private:
  bool skips(interface::Skip skip) const { return options_.compiler.skips.has(skip); }

  // What the camera does not change (plan.cpp).
  struct PassPrograms {
    uint32_t vertex, pixel, blend;  // in Frame::programs
  };
  void begin(const scene::Scene& scene, support::Diagnostics& diagnostics);
  bool check_effects();
  bool find_time();
  /// Whether any program may read other maps of the environment than the sharp one (driver::EnvironmentReads).
  bool reads_blurred_maps() const;
  /// Adds the maps of the environment behind the textures. False after an error.
  bool add_environment();
  support::Source read_document(const std::string& path, const support::Span& where);
  bool may_read(const std::string& path, const support::Span& where);
  bool make_objects();
  /// Makes what has changed since the last scene. False if textures or programs may have changed, and after an error.
  bool update_objects(const PlanKeys& keys);
  std::optional<size_t> find_mesh(size_t o);
  void note_largest_mesh(const scene::Object& object, const StoredMesh& mesh);
  /// The parameters of an object for each part of its mesh.
  using PartValues = std::vector<ParameterValues>;
  std::optional<PartValues> resolve_parts(const scene::Object& object, const driver::Effect& effect,
                                          const StoredMesh& mesh, const FindTexture& find_texture);
  int64_t most_draws(const driver::Effect& effect, const ParameterValues& values) const;
  struct Count {
    std::string_view what;
    int64_t limit;
    int64_t total = 0;
  };
  struct Counts {
    Count vertices, triangles, words, draws;
    size_t views;  ///< at most
  };
  Counts begin_counting() const;
  /// Counts an object; false, and reported, if a limit is exceeded.
  bool count_object(size_t o, Counts& counts);
  std::optional<int> find_texture(const ImageSource& source, const lower::ImageSlot& slot);
  /// The object at the frame before.
  const scene::Object& before(size_t o) const { return object_before(*scene_, o); }
  /// Makes frame_now_ and frame_earlier_; whether they are as they were.
  bool update_frame_words();
  void finish_stats(double seconds);

  // The programs, for the values that the scene fixes (plan_compile.cpp).
  /// Makes the programs of the effects, some of which become several that are compiled for different values.
  void compile_effects();
  bool compile_posts();
  /// What the programs are compiled for.
  driver::CompileOptions compile_options() const;
  /// `cutout`: of a pixel program, the index of the one that belongs to it.
  uint32_t add_program(const driver::Program& program, uint32_t cutout = backends::Frame::no_program);
  bool fixes_parameters() const;
  /// Without those words whose values may change from scene to scene.
  driver::FixedWords given_by(std::string_view owner, const driver::ParameterBlock& block, driver::FixedWords words) const;
  /// The words that an object, or a post, gives for all of its records; none if nothing is fixed.
  driver::FixedWords given_by_object(size_t o, const driver::ParameterBlock& block) const;
  driver::FixedWords given_by_post(size_t p, const driver::ParameterBlock& block) const;
  /// Whether programs that are compiled for fixed values suit those that are given now. Otherwise notes what has changed.
  bool keeps_fixed(const driver::ParameterBlock& block, const driver::FixedWords& fixed, const driver::FixedWords& given);
  bool posts_keep_fixed();
  void report_programs();

  // The images that programs read (plan_images.cpp).
  /// Leaves out of the store what no program reads of an image, and reports it.
  void leave_out_images();

  // The records of all copies (plan_place.cpp).
  /// One pass over a part of a copy. Its records stand one behind the other: of each repetition; where motion is drawn
  /// those again for the motion, and once more as they were at the frame before.
  struct PlacedPass {
    int record = 0;       ///< the first one
    int repetitions = 0;  ///< 0: disabled
    bool blended = false, double_sided = false, cutout = false;
    bool moves = false;  ///< it has records for motion
  };
  struct PlacedCopy {
    glm::mat4 model;
    uint32_t object = 0;
    uint32_t first_pass = 0;  ///< in placed_: for each pass of the effect, each part of the mesh
  };
  struct Placed {
    std::vector<PlacedCopy> copies;
    std::vector<PlacedPass> passes;
    std::vector<glm::mat4> models_before;  ///< of each copy, if motion is drawn
    std::vector<Hull> hulls;               ///< of each copy, if a light has a shadow
    std::vector<float> objects;            ///< their records
    std::vector<RecordOrigin> origins;
    std::optional<DrawEvaluator> evaluator, evaluator_before;  ///< of this frame, and of the one before
  };
  void place_all();
  /// Appends a record, with what is the same for its draws. `words`: of the parameters.
  void append_record(size_t o, const driver::EffectPass& pass, bool blended, const ObjectTransforms& place, uint32_t program,
                     Repetition repetition, std::span<const float> words, Placed& placed, bool before = false) const;
  void place_copy(size_t o, int64_t number, Placed& placed) const;
  void append(Placed& part);
  Hull hull_of(size_t o, const glm::mat4& model) const;
  /// How often a pass is drawn over a part: of a plan for programs that change parameters, as often as it may be.
  int repetitions_of(const driver::Effect& effect, const driver::EffectPass& pass, std::span<const float> parameters) const;
  int record_words(size_t o) const;
  /// Calls use(part) for parts of [0, copies), on all threads; returns their results in order.
  template <class Part, class Make>
  std::vector<Part> in_parts(size_t copies, const Make& make);

  // What each view draws (plan_views.cpp).
  bool make_views(int width, int height);
  void add_view(const scene::Camera& camera, const scene::View& view, int width, int height, backends::Target target);
  void add_views(int width, int height);
  bool is_shadow_map(size_t view) const { return view < shadow_maps_; }
  /// The number of the view that draws what is opaque alone, if there is one.
  size_t opaque_view() const { return shadow_maps_; }
  /// One copy of an object in one view.
  struct Appearance {
    glm::mat4 projected;
    bool outside = true;  ///< of the view: passes that do not move vertices draw nothing
    float nearness = 0;   ///< of the middle of its mesh's bounds: greater the nearer it is
    int matrix = -1;      ///< the first word of `projected` in View::words, once a draw needs it
  };
  struct BlendedDraw {
    float nearness;
    backends::Draw draw;
  };
  struct MovedDraw {
    float nearness;  ///< of what is blended; the rest is drawn first
    backends::Draw now, before;
  };
  /// What some copies add to the views, in the order of the scene.
  struct Seen {
    struct OfView {
      std::vector<float> words;  ///< matrices
      std::vector<backends::Draw> draws;
      std::vector<BlendedDraw> blended;
    };
    std::vector<OfView> views;
    std::vector<MovedDraw> moved, moved_blended;
    std::vector<float> words_before;  ///< matrices of MotionPlan::before
    std::map<uint32_t, std::vector<PassSkips>> skipped;  ///< by object
    PlanStats stats;                                     ///< counts of draws
    std::vector<Appearance> appearances;                 ///< of the copy that is looked at
  };
  void see_copy(size_t number, Seen& seen) const;
  void see_pass(const PlacedCopy& copy, size_t number, size_t pass, Seen& seen) const;
  backends::Draw draw_of(const PlacedCopy& copy, size_t pass, size_t part, int repetition) const;
  void place_draw(backends::Draw draw, size_t view, Seen& seen) const;
  void append(Seen& seen, Seen& all);
  /// Adds the draws that are blended to each view, behind all others.
  void append_blended(Seen& all);
  void number_revisions(const std::vector<backends::View>& former);

  // The lights and their shadow maps (plan_lights.cpp).
  /// Adds the records of the lights, and a view for each of their shadow maps.
  void add_lights(const scene::View& picture);
  void note_largest_shadow(const scene::Light& light, size_t maps);
  void look_at_hulls(const scene::View& picture);

  // The lights of each copy (plan_light_lists.cpp).
  /// By the number of the light.
  struct LightsOfCopy {
    std::vector<bool> reaching, shining;
  };
  /// What was made of the lights and the objects.
  struct LightLists {
    std::vector<float> lights = {};  ///< their records
    uint64_t objects = 0;            ///< Revisions::objects
    std::vector<float> words = {};  ///< what stands behind the records
    std::vector<Skipped> skips = {};
    int64_t left_out = 0;
  };
  /// Appends the lists behind the records of the lights, and writes to each record of an object where its own is.
  void list_lights();
  LightsOfCopy lights_of(const PlacedCopy& copy) const;

  // How far things have moved (plan_motion.cpp), if a post reads that.
  bool may_read_motion() const;
  void begin_motion(int width, int height);
  /// A program that draws motion, with the cut-out of a pixel program.
  uint32_t motion_program(uint32_t pixel);
  void append_motion_records(size_t o, const scene::Instance& instance, size_t part, const driver::EffectPass& pass,
                             const PlacedPass& made, Placed& placed) const;
  /// Adds a draw of the picture to both views. `record`: the pass's.
  void see_motion(const PlacedPass& pass, size_t copy, int repetition, const backends::Draw& draw, float nearness,
                  int& matrix_before, Seen& seen) const;
  void finish_motion(Seen& all);

  const PlanOptions& options_;
  threads::Workers& workers_;
  Compiled& compiled_;
  std::set<std::string> changed_;
  const scene::Scene* scene_ = nullptr;           ///< the one that is planned
  support::Diagnostics* diagnostics_ = nullptr;  ///< of the scene that is planned
  PlanKeys keys_;                                ///< of the scene that was planned last
  Plan plan_;

  std::vector<size_t> effect_of_object_;
  std::vector<std::vector<PassPrograms>> programs_of_effect_;
  std::map<std::string, uint32_t> program_by_text_;
  std::vector<const driver::Post*> posts_;  ///< of each post of the scene
  TextureStore textures_;
  MeshStore meshes_;
  size_t texels_of_textures_ = 0, words_of_textures_ = 0;  ///< in Frame::texels and Frame::textures; maps of the environment follow
  int environment_ = -1;                                   ///< the first record of its maps
  bool has_blurred_maps_ = false;                          ///< all of them are made
  uint32_t most_vertices_ = 0;                             ///< of a mesh
  std::vector<size_t> mesh_of_object_;
  std::vector<PartValues> parameters_;         ///< of each object
  std::vector<PartValues> parameters_before_;  ///< likewise at the frame before; empty where they are the same
  Placed placed_;                              ///< its records and their origins are in the plan
  size_t programs_without_motion_ = 0;
  std::map<uint32_t, uint32_t> motion_programs_;  ///< by the program of the cut-out
  bool has_motion_ = false;                       ///< a post may read it
  bool reads_time_ = false;                       ///< a program may; otherwise frames differ by nothing but their time

  std::vector<scene::View> cameras_;                     ///< of each view of the frame
  size_t shadow_maps_ = 0;                               ///< the views that begin the frame
  uint64_t shadow_texels_ = 0, most_shadow_texels_ = 0;  ///< of all shadow maps; of those of one light
  bool has_opaque_view_ = false;
  std::vector<float> frame_now_, frame_earlier_;         ///< what will be Frame::frame, and what it was at the frame before
  std::vector<Skipped> skipped_in_programs_;
  bool draws_read_frame_ = false;                        ///< what is the same for a draw may depend on it
  std::vector<float> lights_before_, frame_before_;  ///< arrays of the frame before, to compare with
  LightLists light_lists_;                           ///< of the frame before
  std::vector<const driver::Program*> programs_before_;
  std::vector<uint32_t> cutouts_before_;
  glm::mat4 projection_before_{1};
};

/// A number that no array has had so far.
uint64_t next_revision();

bool same_bits(std::span<const float> a, std::span<const float> b);

/// How many copies are worth a task.
inline constexpr size_t copies_of_part = 64;

template <class Part, class Make>
std::vector<Part> Planner::in_parts(size_t copies, const Make& make) {
  std::vector<Part> parts((copies + copies_of_part - 1) / copies_of_part);
  const auto one = [&](size_t p) {
    for (size_t i = p * copies_of_part; i < std::min(copies, (p + 1) * copies_of_part); ++i) make(i, parts[p]);
  };
  if (parts.size() > 1)
    workers_.for_each(parts.size(), one);
  else if (!parts.empty())
    one(0);
  return parts;
}

}  // namespace isoshade::render
