// SPDX-License-Identifier: Apache-2.0
#include "compiler/lower/setup.h"

#include <algorithm>

#include "compiler/functions/triangle_setup.h"
#include "compiler/lower/kernel.h"

namespace isoshade::lower {

namespace {

using Planes = functions::GuardPlanes<Float>;

/// Whether all three points lie beyond one plane; not everywhere where they do.
Bool are_beyond(const std::array<Vec4, 3>& points, const Planes& planes) {
  const auto all = [&](const auto& is_beyond) {
    return (is_beyond(points[0]) & is_beyond(points[1])) & is_beyond(points[2]);
  };
  const auto guard = [&](int axis, bool negated, Float plane) {
    return all([&](Vec4 p) {
      const Float along = negated ? negate(p[axis]) : p[axis];
      return (p[3] > Float(0.0f)) & (along > plane * p[3]);
    });
  };
  const Bool in_depth =
      all([](Vec4 p) { return p[2] > p[3]; }) | all([](Vec4 p) { return p[2] < Float(0.0f); });
  return in_depth | (guard(0, false, planes.right) | guard(0, true, planes.left)) |
         (guard(1, true, planes.bottom) | guard(1, false, planes.top));
}

}  // namespace

uint32_t add_setup_kernel(ir::Module& module) {
  constexpr const char* corners[] = {"first", "second", "third"};
  std::vector<ir::Parameter> parameters;
  for (const char* name : corners) parameters.push_back({name, ir::vector_type(4), "", false});
  for (const char* name : {"a", "b", "c"}) parameters.push_back(int_parameter(name));
  parameters.push_back(uniform_int("surface"));
  std::vector<ir::Result> results{{"state", ir::int_type}};
  for (int i = 0; i < triangle_word::stride; ++i)
    results.push_back({"word_" + std::to_string(i), ir::int_type});
  Kernel k(module, "setup", std::move(parameters), std::move(results));

  const Int surface = k.integer(6);
  const auto word = [&](int at) { return k.load_int(FrameBuffer::inputs, surface, at); };
  const auto number = [&](int at) { return from_bits_normal(word(at)); };
  const auto planes = [&](int at) {
    return Planes{number(at), number(at + 1), number(at + 2), number(at + 3)};
  };
  const Int width = k.named("width", word(surface_word::width)),
            height = k.named("height", word(surface_word::height));
  const Float half_width = k.named("half_width", to_float(width) * Float(0.5f));
  const Float half_height = k.named("half_height", to_float(height) * Float(0.5f));

  const std::array points{k.vector4(0), k.vector4(1), k.vector4(2)};
  const Planes near = planes(surface_word::near_planes);
  const auto is_inside = [&](Vec4 p) { return functions::is_inside<Float>(p[0], p[1], p[2], p[3], near); };
  const Bool inside = k.named("inside", (is_inside(points[0]) & is_inside(points[1])) & is_inside(points[2]));
  const Bool beyond = k.named("beyond", are_beyond(points, planes(surface_word::far_planes)));

  std::vector<functions::CornerOf<Int>> made;
  for (const Vec4& p : points)
    made.push_back(functions::project<Float>(p[0], p[1], p[2], p[3], half_width, half_height));
  const Int x[] = {made[0].x, made[1].x, made[2].x}, y[] = {made[0].y, made[1].y, made[2].y};
  const auto flag = [&](int at) { return word(at) != Int(0); };
  const functions::CullingOf<Int> culling{flag(surface_word::culls_turned),
                                          flag(surface_word::culls_straight),
                                          {k.constant(0), k.constant(0), width - Int(1), height - Int(1)}};
  const auto [is_kept, turned, wide] = functions::decide<Int>(x, y, culling);
  const Bool kept = k.named("kept", inside & is_kept);

  // The vertices of a record turn clockwise on the grid.
  const auto straightened = [&](auto values) {
    const auto second = select(turned, values[2], values[1]), third = select(turned, values[1], values[2]);
    return std::array{values[0], second, third};
  };
  const auto xs = straightened(std::array{x[0], x[1], x[2]}), ys = straightened(std::array{y[0], y[1], y[2]});
  const auto depth_bits = straightened(std::array{made[0].depth, made[1].depth, made[2].depth});
  const auto inverse_w = straightened(std::array{made[0].inverse_w, made[1].inverse_w, made[2].inverse_w});
  const auto vertices = straightened(std::array{k.integer(3), k.integer(4), k.integer(5)});

  const Int moved_x[] = {xs[0], xs[1], xs[2]}, moved_y[] = {ys[0], ys[1], ys[2]};
  Float moved[] = {from_bits_normal(depth_bits[0]), from_bits_normal(depth_bits[1]),
                   from_bits_normal(depth_bits[2])};
  functions::move_depth<Float>(
      moved_x, moved_y, moved,
      {number(surface_word::bias), number(surface_word::bias + 1), number(surface_word::bias + 2)});
  const Bool is_biased = flag(surface_word::is_biased);

  std::vector<ir::ValueId> words(triangle_word::stride, ir::none);
  const auto set = [&](int at, Int value) { words[static_cast<size_t>(at)] = value.id(k.b); };
  for (int i = 0; i < 3; ++i) {
    const auto n = static_cast<size_t>(i);
    set(triangle_word::vertex + i, vertices[n]);
    set(triangle_word::position + 2 * i, select(kept, xs[n], Int(0)));
    set(triangle_word::position + 2 * i + 1, select(kept, ys[n], Int(0)));
    set(triangle_word::depth + i, select(is_biased, bits(moved[i]), depth_bits[n]));
    set(triangle_word::inverse_w + i, inverse_w[n]);
  }
  const Int by_side = select(turned, word(surface_word::if_turned), word(surface_word::if_straight));
  set(triangle_word::object,
      word(surface_word::object) | by_side | select(wide, Int(triangle_flag::wide), Int(0)));
  const Int state = select(inside, select(kept, Int(setup_state::kept), Int(setup_state::dropped)),
                           select(beyond, Int(setup_state::dropped), Int(setup_state::cut)));
  words.insert(words.begin(), state.id(k.b));
  k.b.finish(words);
  return k.index;
}

}  // namespace isoshade::lower
