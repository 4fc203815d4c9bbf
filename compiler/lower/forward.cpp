// SPDX-License-Identifier: Apache-2.0
#include "compiler/lower/forward.h"

#include <algorithm>
#include <functional>

#include "compiler/lower/surface.h"

namespace isoshade::lower {
namespace {

using Kind = ForwardInput::Kind;

ir::Type type_of(const ForwardInput& input) {
  switch (input.kind) {
    case Kind::attribute: return ir::vector_type(input.width);
    case Kind::words:
      if (input.buffer == FrameBuffer::layer_records) return ir::int_type;
      return input.width == 1 ? ir::float_type : ir::vector_type(input.width);
    case Kind::pixel:
    case Kind::index: return ir::int_type;
    case Kind::position:
    case Kind::shown: return ir::vector_type(3);
    case Kind::front: return ir::bool_type;
  }
  support::bug("no such input");
}

/// Which value of its record it is: "object_normal_0".
std::string name_of(const ForwardInput& input) {
  const auto inside = [&](const ir::RecordField& field) {
    return static_cast<uint32_t>(input.word) >= field.first && static_cast<uint32_t>(input.word) < field.first + field.words;
  };
  switch (input.kind) {
    case Kind::attribute: return "attribute";
    case Kind::pixel: return input.word == 0 ? "x" : "y";
    case Kind::index: return "index";
    case Kind::position: return "position";
    case Kind::front: return "front";
    case Kind::shown: return "shown_position";
    case Kind::words: break;
  }
  for (const ir::RecordField& field : fields_of(input.buffer))
    if (inside(field))
      return field.name + (field.words == static_cast<uint32_t>(input.width)
                               ? ""
                               : "_" + std::to_string((static_cast<uint32_t>(input.word) - field.first) /
                                                      static_cast<uint32_t>(input.width)));
  return "size";
}

/// Lights are chosen by an index; all else that is not of a point is the same for a whole draw.
bool is_uniform(const ForwardInput& input) {
  return input.kind == Kind::words && input.buffer != FrameBuffer::lights;
}

/// Gives a kernel its parameters. Which they are is known only when its body asks for them, so a body is built twice: first
/// for this list, in a module that is thrown away, then with it.
class Inputs {
 public:
  Inputs(Kernel& kernel, std::vector<ForwardInput>& list, bool records)
      : k_(kernel), list_(list), records_(records) {}

  ir::ValueId of(const ForwardInput& input) {
    auto found = std::ranges::find(list_, input);
    if (found != list_.end() && !records_) return k_.b.parameter(static_cast<size_t>(found - list_.begin()));
    support::assert_that(records_, "a body asks for other inputs when it is built again");
    if (found == list_.end()) list_.push_back(input);
    const ir::Type type = type_of(input);
    if (type == ir::int_type) return k_.b.constant(0);
    if (type == ir::bool_type) return k_.b.constant(false);
    const ir::ValueId zero = k_.b.constant(0.0f);
    return type.width == 1 ? zero : k_.b.construct(std::vector<ir::ValueId>(type.width, zero));
  }

 private:
  Kernel& k_;
  std::vector<ForwardInput>& list_;
  bool records_;
};

using Body = std::function<std::vector<ir::ValueId>(Kernel&, Inputs&)>;

ForwardFunction add(ir::Module& module, const char* name, std::vector<ForwardInput> inputs,
                    std::vector<ir::Result> results, const Body& body) {
  const auto build = [&](ir::Module& into, bool records) {
    std::vector<ir::Parameter> parameters;
    for (size_t i = 0; i < inputs.size(); ++i)
      parameters.push_back({name_of(inputs[i]), type_of(inputs[i]), "", is_uniform(inputs[i])});
    Kernel k(into, name, std::move(parameters), results);
    Inputs given(k, inputs, records);
    k.read_words_from([&](FrameBuffer buffer, int word, int width) {
      return given.of({Kind::words, buffer, word, width});
    });
    k.b.finish(body(k, given));
    return k.index;
  };
  ir::Module scratch;
  build(scratch, true);
  ForwardFunction made;
  made.function = build(module, false);
  made.inputs = std::move(inputs);
  return made;
}

std::vector<ir::Result> results_of(std::span<const interface::Binding> bindings) {
  std::vector<ir::Result> results;
  for (const interface::Binding& binding : bindings)
    results.push_back({binding.parameter.name, binding.parameter.type});
  return results;
}

}  // namespace

ForwardFunction add_forward_surface(ir::Module& module, std::span<const interface::Binding> bindings,
                                    const char* name) {
  return add(module, name, {}, results_of(bindings), [&](Kernel& k, Inputs& inputs) {
    SurfacePoint surface(k, k.constant(0), [&](int width, int word) {
      return inputs.of({Kind::attribute, FrameBuffer::vertices, word, width});
    }, {[&] { return Bool(k.b, inputs.of({Kind::front, {}, 0, 1})); },
        [&] { return Vec3(k.b, inputs.of({Kind::shown, {}, 0, 3})); }});
    std::vector<ir::ValueId> values;
    for (const interface::Binding& binding : bindings)
      values.push_back(k.named(binding.parameter.name,
                               surface.value(std::get<interface::source::Attribute>(binding.source).value)));
    return values;
  });
}

ForwardFunction add_forward_screen(ir::Module& module, std::span<const interface::Binding> bindings) {
  return add(module, "screen_at", {{Kind::pixel, {}, 0, 1}, {Kind::pixel, {}, 1, 1}}, results_of(bindings),
             [&](Kernel& k, Inputs&) { return screen_values(k, bindings); });
}

ForwardFunction add_forward_light(ir::Module& module) {
  return add(module, "light_at", {{Kind::index, {}, 0, 1}, {Kind::position, {}, 0, 3}},
             {{"direction", ir::vector_type(3)}, {"color", ir::vector_type(3)}}, [](Kernel& k, Inputs&) {
               const auto values =
                   light_values(k, k.integer(0) * Int(light_word::stride), k.vector3(1), {});
               return std::vector<ir::ValueId>(values.begin(), values.end());
             });
}

}  // namespace isoshade::lower
