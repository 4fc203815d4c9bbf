// SPDX-License-Identifier: Apache-2.0
#include "compiler/lower/shadow.h"

#include "compiler/lower/kernel.h"

namespace isoshade::lower {
namespace {

/// Beyond the edges of a map by more than any filter reaches, in texels.
constexpr float outside = 32.0f;
/// The filter is never narrower, because its weights are divided by their sum.
constexpr float narrowest = 0.00390625f;  // 1/256

Float light_word_at(Kernel& k, int word) { return k.load(FrameBuffer::lights, k.integer(0), word); }

/// Which of six maps shows the direction: the one of the axis along which it is longest.
Int face_of(Vec3 direction) {
  const Float x = abs(direction[0]), y = abs(direction[1]), z = abs(direction[2]);
  const auto side = [&](int axis) { return select(direction[axis] < Float(0.0f), Int(2 * axis + 1), Int(2 * axis)); };
  const Bool along_x = (x >= y) & (x >= z);
  return select(along_x, side(0), select(y >= z, side(1), side(2)));
}

/// A shadow map, and where in it a position lies.
struct Place {
  Int first;      ///< its first word in `layers`
  Int size;       ///< of each side, in texels
  Float x, y;     ///< in texels, y down
  Float depth;    ///< reversed
  Bool in_front;  ///< of the light
};

Place place_of(Kernel& k) {
  const Vec3 position = k.vector3(1);
  const Vec3 from_light = position - k.load3(FrameBuffer::lights, k.integer(0), light_word::position);
  const Bool has_six = light_word_at(k, light_word::shadow_maps) > Float(1.0f);
  const Int face = k.named("face", select(has_six, face_of(from_light), Int(0)));
  const Int image = to_int(light_word_at(k, light_word::shadow)) + face * Int(shadow_map_records);
  const Int record = k.named("record", image * Int(image_word::stride));
  const auto field = [&](int word) { return k.load_int(FrameBuffer::layer_records, record + Int(word)); };
  const Int camera = k.named("camera", field(image_word::camera));
  const auto word = [&](int at) { return k.load(FrameBuffer::layers, camera + Int(at)); };
  const auto column = [&](int i) {
    const int at = view_word::view + 3 * i;
    return Vec3(word(at), word(at + 1), word(at + 2));
  };
  const Vec3 view = k.named("view", weighted<Vec3>({column(0), column(1), column(2)}, position) + column(3));
  // The other elements of the matrices of scene::make_view are 0.
  const auto projection = [&](int c, int r) { return word(view_word::projection + 4 * c + r); };
  const Float w = k.named("w", projection(2, 3) * view[2] + projection(3, 3));
  const Float depth = (projection(2, 2) * view[2] + projection(3, 2)) / w;
  const Int size = k.named("size", field(image_word::width));
  const Float half = k.named("half", to_float(size) * Float(0.5f));
  const Float right = k.named("right", (projection(0, 0) * view[0]) / w * half);
  const Float up = k.named("up", (projection(1, 1) * view[1]) / w * half);
  return {field(image_word::first), size, right + half, half - up, k.named("depth", depth), w > Float(0.0f)};
}

/// How much of texel `i` lies between two coordinates.
Float overlap(Int i, Float from, Float to) {
  const Float begin = to_float(i);
  return max(min(begin + Float(1.0f), to) - max(begin, from), Float(0.0f));
}

}  // namespace

void add_shadow_at(ir::Module& module) {
  if (module.find("shadow_at") != ir::none) return;
  Kernel k(module, "shadow_at", {uniform_int("light"), {"position", ir::vector_type(3), "", false}},
           {{"visible", ir::float_type}});
  using Values = std::vector<ir::ValueId>;
  const auto all = [&] { return Values{k.b.constant(1.0f)}; };
  const auto part = [&] {
    const Place place = place_of(k);
    const Float width = k.named("width", max(light_word_at(k, light_word::softness), Float(narrowest)));
    const Float limit = k.named("limit", to_float(place.size) + Float(outside));
    // NaN lies outside, too.
    const auto edge = [&](Float middle) {
      return min(limit, max(Float(-outside), middle - width * Float(0.5f)));
    };
    const Float left = k.named("left", edge(place.x)), top = k.named("top", edge(place.y));
    const Float right = k.named("right_edge", left + width), bottom = k.named("bottom", top + width);
    const Int x0 = k.named("x0", to_int(floor(left))), y0 = k.named("y0", to_int(floor(top)));
    const Float whole = k.named("whole", floor(width));
    const Int taps = k.named("taps", to_int(whole) + select(whole < width, Int(2), Int(1)));
    const auto inside = [&](Int i) { return (i >= Int(0)) & (i < place.size); };

    const auto row = [&](ir::ValueId index, std::span<const ir::ValueId> carried) -> Values {
      const Int y = k.named("y", y0 + Int(k.b, index));
      const Float height = k.named("height", overlap(y, top, bottom));
      const Bool row_inside = k.named("row_inside", inside(y) & place.in_front);
      const auto texel = [&](ir::ValueId column, std::span<const ir::ValueId> sums) -> Values {
        const Int x = k.named("x", x0 + Int(k.b, column));
        const Float area = k.named("area", overlap(x, left, right) * height);
        const Bool shown = k.named("shown", row_inside & inside(x));
        const Int at = select(shown, place.first + (y * place.size + x), place.first);
        const Float nearest = k.named("nearest", k.load(FrameBuffer::layers, at));
        const Bool hidden = k.named("hidden", shown & (nearest > place.depth));
        const Float lit = Float(k.b, sums[0]) + select(hidden, Float(0.0f), area);
        const Float dark = Float(k.b, sums[1]) + select(hidden, area, Float(0.0f));
        return {lit.value, dark.value};
      };
      return k.b.loop(taps.value, carried, texel);
    };
    const std::array nothing{k.b.constant(0.0f), k.b.constant(0.0f)};
    const Values sums = k.b.loop(taps.value, nothing, row);
    const Float lit(k.b, sums[0]), dark(k.b, sums[1]);
    return Values{(lit / (lit + dark)).value};
  };
  const Bool has_shadow = light_word_at(k, light_word::shadow_maps) > Float(0.0f);
  k.b.finish(k.b.branch(has_shadow.value, part, all));
}

}  // namespace isoshade::lower
