// SPDX-License-Identifier: Apache-2.0
#include "compiler/targets/glsl/forward_host.h"

#include <algorithm>

#include "compiler/emit/pure.h"
#include "compiler/support/assert.h"

namespace isoshade::glsl {

using namespace emit;
using interface::HostCall;

namespace {

std::string number(size_t value) { return std::to_string(value); }
/// A name of the wrapper. No name of the shader begins so.
std::string own(std::string_view name) { return "isoshade_" + std::string(name); }

class HostText {
 public:
  HostText(const ForwardProgram& program, bool is_es) : program_(program), pure_(*program.pure), is_es_(is_es) {}

  std::string all() const {
    std::string out = "// What the functions ask for.\n";
    for (const HostCall call : host_calls(pure_)) out += host(call);
    if (program_.sampling == ForwardSampling::samplers)
      for (const ir::Function& function : pure_.module.functions)
        if (is_sampler(pure_, function)) out += sampler(function);
    return out + "\n";
  }

 private:
  std::string prefixed(std::string_view name) const { return name_prefix(pure_) + std::string(name); }
  bool is_post() const { return pure_.functions[program_.main].kind == PureKind::post_process; }

  /// A choice among samplers by a number that runs from 0: what `value` makes of the sampler's name.
  template <class Value>
  static std::string choose(const char* stem, size_t count, const std::string& which, const char* none, Value value) {
    std::string out;
    for (size_t i = 0; i < count; ++i)
      out += "  if (" + which + " == " + number(i) + ") return " + value(stem + number(i)) + ";\n";
    return out + "  return " + none + ";\n}\n";
  }

  // Numbers of images: their place in the list times the levels that one may have, plus a level; and all those once more
  // for each layer after the first.

  bool has_layers() const { return std::ranges::any_of(program_.images, &ForwardImage::layers); }
  std::string image_of(const std::string& value) const {
    const std::string image = value + " / " + number(forward_levels);
    return has_layers() ? image + " % " + number(program_.images.size()) : image;
  }
  static std::string level_of(const std::string& value) { return value + " % " + number(forward_levels); }
  std::string layer_of(const std::string& value) const {
    return value + " / " + number(forward_levels * program_.images.size());
  }

  /// A choice among images by a number: what `value` makes of the sampler's name and of the layer, "" if it has none.
  template <class Value>
  std::string choose_image(const std::string& which, Value value) const {
    size_t next = 0;
    return choose("isoshade_image", program_.images.size(), image_of(which), "vec4(0.0)", [&](const std::string& sampler) {
      return value(sampler, program_.images[next++].layers ? layer_of(which) : "");
    });
  }

  /// A texel of a picture that was drawn before; in OpenGL y is up in it.
  std::string fetch_drawn(const std::string& sampler) const {
    const std::string y = is_es_ ? "textureSize(" + sampler + ", 0).y - 1 - y" : "y";
    return "texelFetch(" + sampler + ", ivec2(x, " + y + "), 0)";
  }

  /// `vec4 sample_linear_clamp(int picture, vec2 texcoord)`, which may take further integers; `level` is in 1/65536.
  std::string sampler(const ir::Function& function) const {
    const bool has_level = function.parameters.back().name == "level";
    std::string rest;
    for (size_t i = 2; i < function.parameters.size(); ++i) rest += ", int " + function.parameters[i].name;
    const std::string level = has_level ? "float(level) / 65536.0" : "float(" + level_of("picture") + ")";
    return "vec4 " + prefixed(function.name) + "(int picture, vec2 texcoord" + rest + ") {\n" +
           choose_image("picture", [&](const std::string& image, const std::string& layer) {
             const std::string place = layer.empty() ? "texcoord" : "vec3(texcoord, float(" + layer + "))";
             return "textureLod(" + image + ", " + place + ", " + level + ")";
           });
  }

  std::string host(HostCall call) const {
    const interface::HostRow& asked = interface::row(call);
    const std::string result = (asked.returns_record() ? "isoshade_" : "") + std::string(asked.result);
    const std::string begin = result + " isoshade_" + std::string(asked.name) + "(" + std::string(asked.parameters) + ") {";
    const auto line = [&](const std::string& value) { return begin + " return " + value + "; }\n"; };
    switch (call) {
      case HostCall::light_count: return line("min(isoshade_lights.count, " + number(most_forward_lights) + ")");
      case HostCall::light:
        return begin + "\n  " + forward_result_record("light_at") + " at = " + own("light_at") +
               "(index, position);\n  return isoshade_Light(at.direction, at.color);\n}\n";
      case HostCall::light_change:
        return begin + "\n  " + forward_result_record("light_at") + " at = " + own("light_at") + "(index, position), next = " +
               own("light_at") + "(index, position + change);\n" +
               "  return isoshade_Light(next.direction - at.direction, next.color - at.color);\n}\n";
      case HostCall::has_environment: return line("false");
      case HostCall::environment:
      case HostCall::irradiance: return line("vec3(0.0)");
      case HostCall::texel:
        return begin + "\n" + choose_image("image", [](const std::string& sampler, const std::string& layer) {
                 const std::string place = layer.empty() ? "ivec2(x, y)" : "ivec3(x, y, " + layer + ")";
                 return "texelFetch(" + sampler + ", " + place + ", " + level_of("image") + ")";
               });
      case HostCall::image_size: return image_size(begin);
      case HostCall::image_layer: return image_layer(begin);
      case HostCall::time: return line((is_post() ? "isoshade_screen" : "isoshade_view") + std::string(".time"));
      case HostCall::pass_index:
      case HostCall::pass_count: return line("isoshade_object." + std::string(asked.name));
      case HostCall::world_from_object:
      case HostCall::object_from_world: return line("isoshade_object." + std::string(asked.name) + "[column].xyz");
      case HostCall::view_from_world:
      case HostCall::world_from_view: return line("isoshade_view." + std::string(asked.name) + "[column].xyz");
      case HostCall::picture:
        return begin + "\n" + choose("isoshade_picture", program_.pictures, "image", "vec4(0.0)",
                                     [&](const std::string& sampler) { return fetch_drawn(sampler); });
      case HostCall::picture_width:
      case HostCall::picture_height: {
        const std::string axis = call == HostCall::picture_width ? ".x" : ".y";
        return begin + "\n" + choose("isoshade_picture", program_.pictures, "image", "1", [&](const std::string& sampler) {
                 return "textureSize(" + sampler + ", 0)" + axis;
               });
      }
      case HostCall::depth: return line(fetch_drawn("isoshade_depth_picture") + ".x");
      case HostCall::depth_width: return line("textureSize(isoshade_depth_picture, 0).x");
      case HostCall::depth_height: return line("textureSize(isoshade_depth_picture, 0).y");
      case HostCall::screen_size: return line("isoshade_screen.size");
      case HostCall::camera_position:
      case HostCall::camera_direction:
      case HostCall::depth_numerator:
      case HostCall::depth_denominator: return line("isoshade_screen." + std::string(asked.name));
    }
    support::bug("no such function of a host");
  }

  std::string image_size(const std::string& begin) const {
    std::string out = begin + "\n  ivec2 size = ivec2(1);\n  int smaller = 0;\n";
    for (size_t i = 0; i < program_.images.size(); ++i) {
      const std::string name = "isoshade_image" + number(i);
      // Not the size of level `image % 16`: lavapipe takes the level of one pixel for its neighbours.
      out += "  if (" + image_of("image") + " == " + number(i) + ") {\n    size = max(textureSize(" + name + ", 0)" +
             (program_.images[i].layers ? ".xy" : "") + " >> " + level_of("image") + ", ivec2(1));\n";
      // GLSL ES cannot ask: the image has all levels down to 1 x 1.
      if (program_.images[i].mips)
        out += is_es_ ? "    smaller = int(floor(log2(float(max(size.x, size.y)))));\n"
                      : "    smaller = textureQueryLevels(" + name + ") - 1 - image % " + number(forward_levels) + ";\n";
      out += "  }\n";
    }
    return out + "  return isoshade_ImageSize(size.x, size.y, smaller);\n}\n";
  }

  std::string image_layer(const std::string& begin) const {
    std::string out = begin + "\n  int layers = 1;\n";
    for (size_t i = 0; i < program_.images.size(); ++i)
      if (program_.images[i].layers)
        out += "  if (" + image_of("image") + " == " + number(i) + ") layers = textureSize(isoshade_image" + number(i) +
               ", 0).z;\n";
    return out + "  return image + clamp(layer, 0, layers - 1) * " + number(forward_levels * program_.images.size()) +
           ";\n}\n";
  }

  const ForwardProgram& program_;
  const PureShader& pure_;
  bool is_es_;
};

}  // namespace

std::string forward_host(const ForwardProgram& program, bool is_es) { return HostText(program, is_es).all(); }

std::string forward_result_record(std::string_view name) {
  std::string record = "isoshade_";
  bool begins = true;
  for (const char c : name) {
    if (c != '_') record += begins && c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    begins = c == '_';
  }
  return record + "Result";
}

}  // namespace isoshade::glsl
