// SPDX-License-Identifier: Apache-2.0
#include "compiler/lower/environment.h"

#include "compiler/functions/environment.h"

namespace isoshade::lower {
namespace {

namespace names = interface::names;

/// The first record of the environment; -1 if the frame has none.
Int first_record(Kernel& k) { return to_int(k.load(FrameBuffer::frame, k.constant(0), frame_word::environment)); }

/// environment_texel(picture, place): of the level with this record, bilinear.
uint32_t add_level_read(ir::Module& module) {
  if (const uint32_t found = module.find(names::environment_texel); found != ir::none) return found;
  Kernel k(module, names::environment_texel, {int_parameter("picture"), {"place", ir::vector_type(2), "", false}},
           {{"radiance", ir::vector_type(3)}});
  const Int record = k.named("record", k.integer(0) * Int(texture_word::stride));
  const auto word = [&](int at) { return k.load_int(FrameBuffer::textures, record + Int(at)); };
  const Int first = k.named("first", word(texture_word::first));
  const Int width = k.named("width", word(texture_word::width));
  constexpr int border = functions::environment_border;
  const Float side = k.named("side", to_float(width - Int(2 * border)));
  const Vec2 place(k.b, k.b.parameter(1));
  // From the middle of the first texel of the border.
  const auto along = [&](int axis) { return place[axis] * side + Float(border - 0.5f); };
  const Float x = k.named("x", along(0)), y = k.named("y", along(1));
  const Float column = k.named("column", floor(x)), row = k.named("row", floor(y));
  const Float x_share = k.named("x_share", x - column), y_share = k.named("y_share", y - row);
  const Int corner =
      k.named("corner", first + shift_left(to_int(row) * width + to_int(column), Int(2)));
  const auto texel = [&](Int word) {
    const auto channel = [&](int i) { return k.load(FrameBuffer::texels, word + Int(i)); };
    return Vec3(channel(0), channel(1), channel(2));
  };
  const auto between = [&](Int word) { return mix(texel(word), texel(word + Int(4)), x_share); };
  const Vec3 upper = k.named("upper", between(corner));
  const Vec3 lower = k.named("lower", between(corner + shift_left(width, Int(2))));
  k.b.finish(std::array{mix(upper, lower, y_share).value});
  return k.index;
}

void define_radiance(ir::Module& module, uint32_t function) {
  const uint32_t read = add_level_read(module);
  Kernel k(module, function);
  const Vec2 place = functions::octahedral_place(k.vector3(0));
  k.named("place", place);
  const Float level = k.named("level", functions::environment_level(Float(k.b, k.b.parameter(1))));
  const Float whole = floor(level);
  const Float last = Float(static_cast<float>(functions::environment_levels - 2));
  const Float lesser = k.named("lesser", select(whole < last, whole, last));
  const Int record = k.named("record", first_record(k) + to_int(lesser));
  const auto at = [&](Int picture) { return Vec3(k.b, k.b.call(read, std::array{picture.id(k.b), place.value})[0]); };
  const Vec3 fine = k.named("fine", at(record));
  const Vec3 coarse = k.named("coarse", at(record + Int(1)));
  k.b.finish(std::array{mix(fine, coarse, level - lesser).value});
}

void define_irradiance(ir::Module& module, uint32_t function) {
  const uint32_t read = add_level_read(module);
  Kernel k(module, function);
  const Vec2 place = functions::octahedral_place(k.vector3(0));
  k.named("place", place);
  const Int record = k.named("record", first_record(k) + Int(functions::environment_levels));
  k.b.finish(std::array{k.b.call(read, std::array{record.id(k.b), place.value})[0]});
}

}  // namespace

void declare_environment(ir::Module& module, interface::Interface& host, interface::Host what) {
  if (host.find(what) != ir::none) return;
  host.host.push_back({what, static_cast<uint32_t>(module.functions.size())});
  ir::Function& function = module.functions.emplace_back();
  const bool is_radiance = what == interface::Host::environment;
  function.name = is_radiance ? names::environment_at : names::irradiance_at;
  function.parameters = {{"direction", ir::vector_type(3), "", false}};
  if (is_radiance) function.parameters.push_back({"roughness", ir::float_type, "", false});
  function.results = {{"radiance", ir::vector_type(3)}};
}

void define_environment(ir::Module& module, const interface::Interface& interface) {
  if (const uint32_t at = interface.find(interface::Host::environment); at != ir::none) define_radiance(module, at);
  if (const uint32_t at = interface.find(interface::Host::irradiance); at != ir::none) define_irradiance(module, at);
}

ir::ValueId has_environment(Kernel& k, std::optional<bool> known) {
  if (known) return k.b.constant(*known);
  return (k.load(FrameBuffer::frame, k.constant(0), frame_word::environment) >= Float(0.0f)).value;
}

}  // namespace isoshade::lower
