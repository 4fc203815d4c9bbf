// SPDX-License-Identifier: Apache-2.0
#include "compiler/lower/sampling.h"

#include <optional>

#include "compiler/lower/kernel.h"

namespace isoshade::lower {
namespace {

namespace names = interface::names;
using nodes::AddressMode;
using nodes::Filter;

struct Size {
  Int width, height, smaller;
};

/// A sampler's module, and the list of what it asks its host for.
struct Samplers {
  ir::Module& module;
  interface::Interface& interface;

  void note(interface::Host host, uint32_t function) { interface.host.push_back({host, function}); }

  uint32_t declared(interface::Host host, const char* name, std::vector<ir::Parameter> parameters,
                    std::vector<ir::Result> results) {
    if (const uint32_t found = interface.find(host); found != ir::none) return found;
    ir::Function& function = module.functions.emplace_back();
    function.name = name;
    function.parameters = std::move(parameters);
    function.results = std::move(results);
    note(host, static_cast<uint32_t>(module.functions.size() - 1));
    return interface.host.back().function;
  }
  uint32_t texture_size() {
    return declared(interface::Host::texture_size, names::texture_size, {int_parameter("picture")},
                    {{"width", ir::int_type}, {"height", ir::int_type}, {"smaller", ir::int_type}});
  }
  uint32_t texture_layer() {
    return declared(interface::Host::texture_layer, names::texture_layer,
                    {int_parameter("picture"), int_parameter("layer")}, {{"picture", ir::int_type}});
  }
  uint32_t texel_at() {
    return declared(interface::Host::texel, names::texel_at,
                    {int_parameter("picture"), int_parameter("x"), int_parameter("y")},
                    {{"texel", ir::vector_type(4)}});
  }
};

Size size_of(Samplers& samplers, ir::Builder& b, ir::ValueId texture) {
  const std::vector<ir::ValueId> words = b.call(samplers.texture_size(), std::array{texture});
  return {Int(b, words[0]), Int(b, words[1]), Int(b, words[2])};
}

Vec4 texel_at(Samplers& samplers, ir::Builder& b, ir::ValueId texture, Int x, Int y) {
  return Vec4(b, b.call(samplers.texel_at(), std::array{texture, x.id(b), y.id(b)})[0]);
}

/// Where coordinates beyond the texture are read: fixed, or by a number.
struct Mode {
  AddressMode fixed{};
  std::optional<Int> chosen = {};

  Bool is(AddressMode mode) const { return *chosen == Int(static_cast<int>(mode)); }
};

/// A coordinate brought into [0, 1].
Float within(const Mode& mode, Float coordinate) {
  if (mode.chosen)
    return functions::traced::branch(
        mode.is(AddressMode::periodic), [&] { return wrap(coordinate); },
        [&] { return select(mode.is(AddressMode::mirror), mirror(coordinate), saturate(coordinate)); });
  switch (mode.fixed) {
    case AddressMode::periodic: return wrap(coordinate);
    case AddressMode::mirror: return mirror(coordinate);
    case AddressMode::clamp:
    case AddressMode::constant: break;
  }
  return saturate(coordinate);
}

/// The column in which a coordinate lies, or the row.
Int nearest(const Mode& mode, Float coordinate, Int size) {
  const Int last = size - Int(1);
  const Int found = to_int(within(mode, coordinate) * to_float(size));  // `size` for 1
  return select(found < last, found, last);
}

/// The columns, or rows, between whose middles a coordinate lies, and how far it is on the way to the second.
struct Between {
  Int first, second;
  Float share;
};

Between between(Kernel& k, char name, const Mode& mode, Float coordinate, Int size) {
  const Float place = within(mode, coordinate) * to_float(size) - Float(0.5f);  // in [-0.5, size - 0.5]
  const Float whole = floor(place);
  const Int first = to_int(whole);
  const Int second = first + Int(1);
  const Int last = size - Int(1);
  const std::string axis(1, name);
  // What lies before the first texel, and after the last.
  Int before = Int(0), after = last;
  if (mode.chosen) {
    before = select(mode.is(AddressMode::periodic), last, Int(0));
    after = select(mode.is(AddressMode::periodic), Int(0), last);
  } else if (mode.fixed == AddressMode::periodic) {
    before = last;
    after = Int(0);
  }
  return {k.named(axis + "0", select(first < Int(0), before, first)),
          k.named(axis + "1", select(second > last, after, second)),
          k.named(axis + "_share", place - whole)};
}

std::string mode_text(AddressMode mode) {
  constexpr std::string_view names[] = {"periodic", "clamp", "mirror", "clamp"};
  return std::string(names[static_cast<size_t>(mode)]);
}

/// Which function of the module samples.
struct Sampler {
  Filter filter;
  AddressMode u, v;
  bool by_mode;  ///< it takes the modes as arguments
};

/// "sample_linear_clamp", or with the mode of each axis; "sample_linear_by_mode".
std::string sample_name(const Sampler& sampling) {
  constexpr std::string_view filters[] = {"closest_", "linear_", "trilinear_"};
  const std::string u = mode_text(sampling.u), v = mode_text(sampling.v);
  const std::string modes = sampling.by_mode ? "by_mode" : u + (u == v ? "" : "_" + v);
  return names::sample_prefix + std::string(filters[static_cast<size_t>(sampling.filter)]) + modes;
}

std::vector<ir::Parameter> sample_parameters(const Sampler& sampling) {
  std::vector<ir::Parameter> parameters{int_parameter("picture"), {"texcoord", ir::vector_type(2), "", false}};
  if (!sampling.by_mode) return parameters;
  parameters.push_back(int_parameter("u_mode"));
  parameters.push_back(int_parameter("v_mode"));
  return parameters;
}

/// The modes of u and v, by the parameters of the kernel.
std::array<Mode, 2> modes_of(Kernel& k, const Sampler& sampling) {
  if (!sampling.by_mode) return {Mode{sampling.u}, Mode{sampling.v}};
  return {Mode{{}, k.integer(2)}, Mode{{}, k.integer(3)}};
}

void build_closest(Samplers& samplers, Kernel& k, const Sampler& sampling, ir::ValueId texture, Vec2 texcoord) {
  const Size size = size_of(samplers, k.b, texture);
  const auto [u, v] = modes_of(k, sampling);
  const Int x = k.named("x", nearest(u, texcoord[0], size.width));
  const Int y = k.named("y", nearest(v, texcoord[1], size.height));
  k.b.finish(std::array{texel_at(samplers, k.b, texture, x, y).value});
}

void build_linear(Samplers& samplers, Kernel& k, const Sampler& sampling, ir::ValueId texture, Vec2 texcoord) {
  const Size size = size_of(samplers, k.b, texture);
  const auto [u, v] = modes_of(k, sampling);
  const Between x = between(k, 'x', u, texcoord[0], size.width);
  const Between y = between(k, 'y', v, texcoord[1], size.height);
  const auto row = [&](Int at) {
    return mix(texel_at(samplers, k.b, texture, x.first, at), texel_at(samplers, k.b, texture, x.second, at), x.share);
  };
  const Vec4 upper = k.named("upper", row(y.first));
  const Vec4 lower = k.named("lower", row(y.second));
  k.b.finish(std::array{mix(upper, lower, y.share).value});
}

/// The function for closest or linear.
uint32_t sampler(Samplers& samplers, const Sampler& sampling) {
  const std::string name = sample_name(sampling);
  if (const uint32_t found = samplers.module.find(name); found != ir::none) return found;
  Kernel k(samplers.module, name, sample_parameters(sampling), {{"color", ir::vector_type(4)}});
  const bool closest = sampling.filter == Filter::closest;
  samplers.note(closest ? interface::Host::sample_closest : interface::Host::sample_linear, k.index);
  (closest ? build_closest : build_linear)(samplers, k, sampling, k.b.parameter(0), Vec2(k.b, k.b.parameter(1)));
  return k.index;
}

/// sample_level(picture, along_x, along_y): the mip level for these changes of the texture coordinates along the sides of
/// a pixel, in 1/65536: an integer, so that it has no derivative.
ir::ValueId level_of(Samplers& samplers, ir::Builder& b, ir::ValueId texture, ir::ValueId texcoord) {
  const std::array arguments{texture, b.op(ir::Opcode::ddx, {texcoord}), b.op(ir::Opcode::ddy, {texcoord})};
  if (const uint32_t found = samplers.interface.find(interface::Host::mip_level); found != ir::none)
    return b.call(found, arguments)[0];
  Kernel k(samplers.module, std::string(names::sample_prefix) + "level",
           {int_parameter("picture"),
            {"along_x", ir::vector_type(2), "", false},
            {"along_y", ir::vector_type(2), "", false}},
           {{"level", ir::int_type}});
  samplers.note(interface::Host::mip_level, k.index);
  const Size size = size_of(samplers, k.b, k.b.parameter(0));
  const Vec2 texels(to_float(size.width), to_float(size.height));
  const Float wanted = mip_level(Vec2(k.b, k.b.parameter(1)) * texels, Vec2(k.b, k.b.parameter(2)) * texels);
  const Float last = to_float(size.smaller);
  const Float from_0 = select(wanted > Float(0.0f), wanted, Float(0.0f));  // NaN too
  const Float level = k.named("level", select(from_0 < last, from_0, last));
  k.b.finish(std::array{to_int(level * Float(0x1p16f)).value});
  return b.call(k.index, arguments)[0];
}

/// sample_trilinear_...(picture, texcoord, ..., level): between the two mip levels around one, in 1/65536.
uint32_t trilinear_sampler(Samplers& samplers, const Sampler& sampling) {
  const std::string name = sample_name(sampling);
  if (const uint32_t found = samplers.module.find(name); found != ir::none) return found;
  const uint32_t linear = sampler(samplers, {Filter::linear, sampling.u, sampling.v, sampling.by_mode});
  std::vector<ir::Parameter> parameters = sample_parameters(sampling);
  const size_t last = parameters.size();
  parameters.push_back(int_parameter("level"));
  Kernel k(samplers.module, name, std::move(parameters), {{"color", ir::vector_type(4)}});
  samplers.note(interface::Host::sample_trilinear, k.index);
  const auto at = [&](Int texture) {
    std::vector<ir::ValueId> arguments{texture.value};
    for (size_t i = 1; i < last; ++i) arguments.push_back(k.b.parameter(i));
    return Vec4(k.b, k.b.call(linear, arguments)[0]);
  };
  const Int level = k.integer(last);
  const Int larger = k.named("larger", k.integer(0) + shift_right(level, Int(16)));
  const Int rest = level & Int(65535);
  const Vec4 fine = k.named("fine", at(larger));
  // A level that is reached is read alone: the next may not be there.
  const Vec4 color = functions::traced::branch(
      rest > Int(0), [&] { return mix(fine, at(larger + Int(1)), to_float(rest) * Float(0x1p-16f)); },
      [&] { return fine; });
  k.b.finish(std::array{color.value});
  return k.index;
}

/// texel_at of a texture whose texels begin at `first`, of the texel at `place` after it. No branch: the word of bytes,
/// which of floats is nobody's, costs less.
Vec4 load_texel(Kernel& k, Int first, Int place, Int table) {
  const Bool floats = table < Int(0);
  const Int bytes =
      k.named("bytes", k.load_int(FrameBuffer::texel_bytes, select(floats, Int(0), first + place)));
  const Int words = k.named("words", first + shift_left(place, Int(2)));
  const auto load = [&](int channel, Int table, Int byte) {
    return k.load(FrameBuffer::texels, select(floats, words + Int(channel), table + byte));
  };
  const auto byte = [&](int i) { return shift_right(bytes, Int(8 * i)) & Int(255); };
  return Vec4(load(0, table, bytes & Int(255)), load(1, table, byte(1)), load(2, table, byte(2)),
              k.load(FrameBuffer::texels, select(floats, words + Int(3), shift_right(bytes, Int(24)))));
}

}  // namespace

ir::ValueId sample(ir::Builder& b, interface::Interface& interface, const Sampling& sampling, ir::ValueId texture,
                   ir::ValueId texcoord, const Chosen& chosen) {
  Samplers samplers{b.module(), interface};
  if (chosen.layer != ir::none) texture = b.call(samplers.texture_layer(), std::array{texture, chosen.layer})[0];
  const bool by_mode = chosen.u != ir::none || chosen.v != ir::none;
  std::vector<ir::ValueId> arguments{texture, texcoord};
  if (by_mode) {
    const auto number = [&](ir::ValueId mode, AddressMode fixed) {
      return mode != ir::none ? mode : b.constant(static_cast<int>(fixed));
    };
    arguments.push_back(number(chosen.u, sampling.u));
    arguments.push_back(number(chosen.v, sampling.v));
  }
  const auto read = [&](Filter filter) {
    return b.call(sampler(samplers, {filter, sampling.u, sampling.v, by_mode}), arguments)[0];
  };
  const auto read_levels = [&](ir::ValueId level) {
    std::vector<ir::ValueId> all = arguments;
    all.push_back(level);
    return b.call(trilinear_sampler(samplers, {Filter::trilinear, sampling.u, sampling.v, by_mode}), all)[0];
  };
  if (chosen.filter == ir::none)
    return sampling.filter == Filter::trilinear ? read_levels(level_of(samplers, b, texture, texcoord))
                                                : read(sampling.filter);
  const auto is = [&](Filter filter) {
    return b.op(ir::Opcode::ieq, {chosen.filter, b.constant(static_cast<int>(filter))});
  };
  const auto closest = [&] { return std::vector{read(Filter::closest)}; };
  const auto interpolated = [&] {
    if (!chosen.may_be_trilinear) return std::vector{read(Filter::linear)};
    // At level 0 the larger texture is read alone, as by the linear filter.
    const ir::ValueId level = level_of(samplers, b, texture, texcoord);
    return std::vector{
        read_levels(b.op(ir::Opcode::select, {is(Filter::trilinear), level, b.constant(0)}))};
  };
  return b.branch(is(Filter::closest), closest, interpolated).front();
}

void define_texture_reads(ir::Module& module, const interface::Interface& interface) {
  const auto word = [](Kernel& k, int at) {
    return k.load_int(FrameBuffer::textures, k.integer(0) * Int(texture_word::stride) + Int(at));
  };
  if (const uint32_t size = interface.find(interface::Host::texture_size); size != ir::none) {
    Kernel k(module, size);
    k.b.finish(std::array{word(k, texture_word::width).value, word(k, texture_word::height).value,
                          word(k, texture_word::smaller).value});
  }
  if (const uint32_t layer = interface.find(interface::Host::texture_layer); layer != ir::none) {
    Kernel k(module, layer);
    const Int last = word(k, texture_word::layers) - Int(1);
    const Int from_0 = select(k.integer(1) > Int(0), k.integer(1), Int(0));
    const Int found = k.named("found", select(from_0 < last, from_0, last));
    const Int records = word(k, texture_word::smaller) + Int(1);
    k.b.finish(std::array{(k.integer(0) + found * records).value});
  }
  if (const uint32_t texel = interface.find(interface::Host::texel); texel != ir::none) {
    Kernel k(module, texel);
    const Int place = k.named("place", k.integer(2) * word(k, texture_word::width) + k.integer(1));
    const Int first = k.named("first", word(k, texture_word::first));
    const Int table = k.named("table", word(k, texture_word::table));
    k.b.finish(std::array{load_texel(k, first, place, table).value});
  }
}

}  // namespace isoshade::lower
