// SPDX-License-Identifier: Apache-2.0
// The kernel around `post_process`: what it reads, by frame_layout.h.
#include <algorithm>
#include <memory>

#include "compiler/lower/environment.h"
#include "compiler/lower/forward.h"
#include "compiler/lower/kernel.h"
#include "compiler/lower/lower.h"
#include "compiler/lower/stages.h"

namespace isoshade::lower {
namespace {

using interface::Axis;
using interface::Screen;

Int image_size(Kernel& k, int image, int word) {
  return k.load_int(FrameBuffer::layer_records, k.constant(0), image * image_word::stride + word);
}

/// under(at, made, read): of `read` pixels side by side, which lies under the centre of pixel `at` where there are
/// `made` of them, and where in it: 0 to 1. Both are in integers up to the last division.
uint32_t add_under(ir::Module& module) {
  if (const uint32_t found = module.find("under"); found != ir::none) return found;
  Kernel k(module, "under", {int_parameter("at"), uniform_int("made"), uniform_int("read")},
           {{"place", ir::int_type}, {"inside", ir::float_type}});
  const Int twice = k.named("twice", shift_left(k.integer(1), Int(1)));
  const Int centre = k.named("centre", (shift_left(k.integer(0), Int(1)) + Int(1)) * k.integer(2));
  const Float width = k.named("width", to_float(twice));
  const Int guess = k.named("guess", to_int(floor(to_float(centre) / width)));
  const Int rest = k.named("rest", centre - guess * twice);
  const Int step = k.named("step", select(rest < Int(0), Int(-1), select(rest >= twice, Int(1), Int(0))));
  const Int place = k.named("place", guess + step);
  const Float inside = to_float(rest - step * twice) / width;
  // Images of one size are usual, and spare all of that.
  const Bool same = k.named("same", k.integer(1) == k.integer(2));
  k.b.finish(std::array{select(same, k.integer(0), place).value, k.named("inside", select(same, Float(0.5f), inside)).value});
  return k.index;
}

/// NAME_at(x, y): a pixel of the image.
void define_read(ir::Module& module, uint32_t function, int image) {
  Kernel k(module, function);
  const Int first = image_size(k, image, image_word::first);
  const Int width = image_size(k, image, image_word::width);
  const Int place = k.named("place", k.integer(1) * width + k.integer(0));
  if (image == image_record::depth) {
    k.b.finish(std::array{k.load(FrameBuffer::layers, first + place).value});
  } else {
    k.b.finish(std::array{k.load4(FrameBuffer::layers, first + shift_left(place, Int(2)), 0).value});
  }
}

/// The arguments of `post_process`, each made once and only if it is asked for.
class ScreenPoint {
 public:
  ScreenPoint(Kernel& kernel, const interface::RecordLayout& record, std::optional<bool> has_environment)
      : k_(kernel), record_(record), has_environment_(has_environment) {}

  ir::ValueId argument(const interface::Binding& binding) {
    namespace source = interface::source;
    const ir::Type type = binding.parameter.type;
    const auto field = [&](int word) { return load_field(k_, type, k_.constant(0), word); };
    const auto only_effects = [&]() -> ir::ValueId {
      support::bug("only effects have " + binding.parameter.name);
    };
    const ir::ValueId value = std::visit(
        interface::Cases{
            [&](const source::Attribute&) { return only_effects(); },
            [&](const source::MatrixColumn&) { return only_effects(); },
            [&](const source::Image&) { return only_effects(); },
            [&](const source::PassRepetition&) { return only_effects(); },
            [&](const source::LightCount&) { return only_effects(); },
            [&](const source::FirstLight&) { return only_effects(); },
            [&](const source::Time&) { return k_.load(FrameBuffer::frame, k_.constant(frame_word::time)).value; },
            [&](const source::HasEnvironment&) { return has_environment(k_, has_environment_); },
            [&](const source::Input& s) { return field(column_word(record_, s, type)); },
            [&](const source::ScreenValue& s) { return screen(s.value); },
            [&](const source::PixelOfImage& s) { return spot_in(s.image).pixel[index(s.axis)].value; },
            [&](const source::OffsetInPixel& s) {
              const Spot& spot = spot_in(s.image);
              return Vec2(spot.inside[0], spot.inside[1]).value;
            },
            [&](const source::SizeOfImage& s) {
              const int word = s.axis == Axis::x ? image_word::width : image_word::height;
              return image_size(k_, static_cast<int>(s.image), word).value;
            },
            [&](const source::TapCount& s) {
              const auto found = std::ranges::find(record_.taps, s.node, &std::pair<uint32_t, int>::first);
              support::assert_that(found != record_.taps.end(), binding.parameter.name);
              return field(found->second);
            },
        },
        binding.source);
    return k_.named(binding.parameter.name, value);
  }

 private:
  Int made(int axis) {
    Int& value = made_[static_cast<size_t>(axis)];
    if (value.builder == nullptr) {
      value = image_size(k_, image_record::made, axis == 0 ? image_word::width : image_word::height);
      k_.named(axis == 0 ? "made_width" : "made_height", value);
    }
    return value;
  }
  Float centre(int axis) { return to_float(k_.integer(static_cast<size_t>(axis))) + Float(0.5f); }
  Float coordinate(int axis) { return centre(axis) / to_float(made(axis)); }

  /// From -1 at the left or upper edge to 1 at the other. Both sides of the fraction are exact.
  Float from_middle(int axis) {
    const Int twice = shift_left(k_.integer(static_cast<size_t>(axis)), Int(1));
    return to_float((twice + Int(1)) - made(axis)) / to_float(made(axis));
  }

  /// A vector in the middle of the screen, and what it changes by to the right and downwards.
  ir::ValueId over_screen(int word) {
    const auto vector = [&](int i) { return k_.load3(FrameBuffer::view, k_.constant(0), word + 3 * i); };
    const Vec3 across = vector(1) * functions::splat<3>(from_middle(0));
    const Vec3 down = vector(2) * functions::splat<3>(from_middle(1));
    return ((vector(0) + across) + down).value;
  }

  ir::ValueId view_vector2(int word) {
    const auto load = [&](int at) { return k_.load(FrameBuffer::view, k_.constant(0), at); };
    return Vec2(load(word), load(word + 1)).value;
  }
  ir::ValueId view_vector3(int word) { return k_.load3(FrameBuffer::view, k_.constant(0), word).value; }

  ir::ValueId screen(Screen value) {
    switch (value) {
      case Screen::pixel: return Vec2(centre(0), centre(1)).value;
      case Screen::coordinate: return Vec2(coordinate(0), coordinate(1)).value;
      case Screen::view_ray: return over_screen(view_word::view_ray);
      case Screen::relative_origin: return over_screen(view_word::ray_origin);
      case Screen::size: return Vec2(to_float(made(0)), to_float(made(1))).value;
      case Screen::camera_position: return view_vector3(view_word::camera_position);
      case Screen::camera_direction: return view_vector3(view_word::camera_direction);
      case Screen::depth_numerator: return view_vector2(view_word::depth_numerator);
      case Screen::depth_denominator: return view_vector2(view_word::depth_denominator);
    }
    support::bug("no such value of the screen");
  }

  static size_t index(Axis axis) { return static_cast<size_t>(axis); }

  struct Spot {
    interface::ImageNumber image;
    std::vector<Int> pixel;
    std::vector<Float> inside;
  };
  const Spot& spot_in(interface::ImageNumber image) {
    for (const Spot& spot : spots_)
      if (spot.image == image) return spot;
    const uint32_t under = add_under(k_.b.module());
    Spot spot{image, {}, {}};
    for (const int axis : {0, 1}) {
      const Int read = image_size(k_, static_cast<int>(image), axis == 0 ? image_word::width : image_word::height);
      const std::array arguments{k_.b.parameter(static_cast<size_t>(axis)), made(axis).value, read.value};
      const std::vector<ir::ValueId> results = k_.b.call(under, arguments);
      spot.pixel.emplace_back(k_.b, results[0]);
      spot.inside.emplace_back(k_.b, results[1]);
    }
    spots_.push_back(std::move(spot));
    return spots_.back();
  }

  Kernel& k_;
  const interface::RecordLayout& record_;
  std::optional<bool> has_environment_;
  std::array<Int, 2> made_{Int(0), Int(0)};
  std::vector<Spot> spots_;
};

}  // namespace

std::vector<ir::ValueId> screen_values(Kernel& k, std::span<const interface::Binding> bindings) {
  const interface::RecordLayout none;
  ScreenPoint screen(k, none, false);
  std::vector<ir::ValueId> values;
  for (const interface::Binding& binding : bindings) values.push_back(screen.argument(binding));
  return values;
}

std::function<ir::ValueId(const interface::Binding&)> screen_arguments(Kernel& kernel) {
  static const interface::RecordLayout none;  // it is the tap counts of posts that need one
  return [screen = std::make_shared<ScreenPoint>(kernel, none, false)](const interface::Binding& binding) {
    return screen->argument(binding);
  };
}

uint32_t add_backdrop_motion_kernel(ir::Module& module) {
  Kernel k(module, "post", {int_parameter("x"), uniform_int("y")}, {{"color", ir::vector_type(4)}});
  const auto screen = screen_arguments(k);
  const Vec3 ray(k.b, screen(interface::bind(Screen::view_ray)));
  const Vec2 coordinate(k.b, screen(interface::bind(Screen::coordinate)));
  const Vec2 size(k.b, screen(interface::bind(Screen::size)));
  // Of x, y and w.
  const auto in_clip_space = [&](int first) {
    const auto row = [&](int i) { return dot(k.load3(FrameBuffer::objects, k.constant(0), first + 3 * i), ray); };
    return Vec3(row(0), row(1), row(2));
  };
  const Vec3 now = k.named("now", in_clip_space(0)), before = k.named("before", in_clip_space(9));
  const Vec2 from_middle(coordinate[0] * Float(2.0f) - Float(1.0f), Float(1.0f) - coordinate[1] * Float(2.0f));
  const Vec2 half_size(size[0] * Float(0.5f), size[1] * Float(-0.5f));
  const Vec2 moved = k.named("moved", moved_pixels(k, from_middle, now[2], now - before, half_size));
  const Int first = image_size(k, image_record::color, image_word::first);
  const Int width = image_size(k, image_record::color, image_word::width);
  const Int place = k.named("place", k.integer(1) * width + k.integer(0));
  const Vec4 drawn = k.named("drawn", k.load4(FrameBuffer::layers, first + shift_left(place, Int(2)), 0));
  const Bool is_drawn = drawn[3] > Float(0.0f);
  const auto along = [&](int axis) { return select(is_drawn, drawn[axis], moved[axis]); };
  k.b.finish(std::array{Vec4(along(0), along(1), Float(0.0f), Float(1.0f)).value});
  return k.index;
}

void define_reads(ir::Module& module, const interface::Interface& interface) {
  for (const interface::HostFunction& read : interface.host)
    if (read.host == interface::Host::depth || read.host == interface::Host::image)
      define_read(module, read.function, static_cast<int>(read.image));
}

uint32_t add_post_kernel(ir::Module& module, const interface::Interface& interface,
                         const interface::RecordLayout& record, LightKinds lights) {
  define_reads(module, interface);
  define_environment(module, interface);
  Kernel k(module, "post", {int_parameter("x"), uniform_int("y")}, {{"color", ir::vector_type(4)}});
  ScreenPoint screen(k, record, lights.environment);
  std::vector<ir::ValueId> arguments;
  for (const interface::Binding& binding : interface.bindings) arguments.push_back(screen.argument(binding));
  k.b.finish(k.b.call(interface.entry, arguments));
  return k.index;
}

}  // namespace isoshade::lower
