// SPDX-License-Identifier: Apache-2.0
// The nodes of one document as the body of one function.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "compiler/check/typed_graph.h"
#include "compiler/interface/binding.h"
#include "compiler/ir/builder.h"
#include "compiler/lower/image_slots.h"
#include "compiler/lower/lower.h"
#include "compiler/lower/screen.h"
#include "compiler/nodes/site.h"

namespace isoshade::lower {

/// The nodes that some operands of a document depend on, and what these nodes need from outside.
struct Needs {
  std::vector<bool> nodes;
  std::vector<bool> inputs;                                ///< but those of images
  std::array<bool, interface::surface_value_count> surface{};   ///< by SurfaceValue::index
  std::array<size_t, interface::space_matrix_count> columns{};  ///< of each SpaceMatrix
  bool time = false;
  std::array<bool, interface::repetition_count> repetition{};  ///< by Repetition
  std::array<interface::Assumption, interface::repetition_count> repetition_range{interface::assume::pass_index,
                                                                                  interface::assume::pass_count};
  bool lights = false;    ///< a sum over lights
  bool light_at = false;  ///< what a light gives
  bool has_environment = false;                ///< whether there is an environment
  bool radiance = false, irradiance = false;  ///< of the environment
  ScreenNeeds screen;

  Needs(const check::TypedGraph& graph, std::span<const check::Operand> results);
  /// Adds what a function that one of the nodes calls has as parameters, but for its inputs and images.
  void add_callee(const std::vector<interface::Binding>& bindings);
  /// The nodes are those of a pass that is repeated so.
  void draw_in(const graph::Graph& graph, const interface::Repeat& repeat);
  /// Adds what is the same for a whole draw: the time, the repetition of the pass, whether there is an environment.
  void add_frame(std::vector<interface::Binding>& bindings) const;
  /// No vertices move: what is seen is the mesh itself.
  void show_mesh();
};

/// A function of the module that a body calls.
struct Callee {
  uint32_t function = 0;
  std::vector<interface::Binding> bindings;  ///< of its parameters
};

/// What the body reads from its function's parameters and calls in its module. Where a value is not needed it is none.
struct Environment {
  /// Of a function whose parameters are bound so. `host` receives the functions that the body asks its host for.
  Environment(ir::Builder& b, const check::TypedGraph& graph, const std::vector<interface::Binding>& bindings,
              interface::Interface& host);

  interface::Interface& interface;
  std::vector<nodes::Value> inputs;  ///< of Graph::inputs
  std::array<ir::ValueId, interface::surface_value_count> surface{};
  std::array<std::array<ir::ValueId, 4>, interface::space_matrix_count> matrices{};
  ir::ValueId time = ir::none;
  std::array<ir::ValueId, interface::repetition_count> repetition{ir::none, ir::none};
  ir::ValueId light_count = ir::none;
  ir::ValueId first_light = ir::none;  ///< none: they are not listed
  ir::ValueId has_environment = ir::none;
  const ImageSlots* images = nullptr;
  std::vector<ir::ValueId> image_slots;  ///< of the slots: the texture, negative for none
  ScreenInputs screen;
  std::function<const Callee&(const check::TypedGraph&)> callee_of;  ///< the function of a document
  std::vector<uint32_t>* node_of_origin = nullptr;                ///< if given: filled, see NodesOfOrigins
};

inline constexpr interface::SurfaceValue world_position{interface::Surface::position};
/// Where lights are asked. It equals world_position unless the pass moves vertices: then it is a parameter of its own.
inline constexpr interface::SurfaceValue shown_position{interface::Surface::shown_position};

/// The value that a node of a surface attribute reads.
interface::SurfaceValue surface_value(const check::TypedGraph& graph, const check::Node& node);

/// One step of a transformation between spaces; a normal is multiplied by the transpose of the inverse matrix.
struct SpaceStep {
  interface::SpaceMatrix matrix;
  bool transposed;
};
/// The steps from one space to another, through world space.
std::vector<SpaceStep> steps_between_spaces(const check::TypedGraph& graph, const check::Node& node,
                                            nodes::Transform what);

/// Makes the needed nodes and returns the results, of the types that they are needed in.
std::vector<nodes::Value> build_body(ir::Builder& builder, const check::TypedGraph& graph, const Needs& needs,
                                     const Environment& environment, std::span<const check::Operand> results);

}  // namespace isoshade::lower
