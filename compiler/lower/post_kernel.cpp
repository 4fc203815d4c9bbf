// SPDX-License-Identifier: Apache-2.0
// The kernel around `post_process`: what it reads, by frame_layout.h.
#include "compiler/lower/kernel.h"
#include "compiler/lower/lower.h"
#include "compiler/lower/stages.h"

namespace isoshade::lower {
namespace {

Int image_size(Kernel& k, int image, int word) {
  const Int at(k.b, k.b.constant(image * image_word::stride + word));
  return k.load_int(FrameBuffer::layer_records, at);
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
  k.b.finish(std::array{place.value, k.named("inside", inside).value});
  return k.index;
}

/// NAME_at(x, y): a pixel of the image.
void define_read(ir::Module& module, uint32_t function, int image) {
  Kernel k(module, function);
  const Int first = image_size(k, image, image_word::first);
  const Int width = image_size(k, image, image_word::width);
  const Int place = k.named("place", k.integer(1) * width + k.integer(0));
  if (image == image_word::depth) {
    k.b.finish(std::array{k.load(FrameBuffer::layers, first + place).value});
  } else {
    k.b.finish(std::array{k.load4(FrameBuffer::layers, first + shift_left(place, Int(2)), 0).value});
  }
}

/// What `post_process` may ask for, each made once and only if it does.
class ScreenPoint {
 public:
  ScreenPoint(Kernel& kernel, const std::vector<std::string>& images) : k_(kernel), images_(images) {}

  ir::ValueId field(const ir::Parameter& parameter) {
    const std::string& name = parameter.name;
    if (parameter.group == screen_group) return k_.named(name, varying(name));
    if (parameter.group == sizes_group) return k_.named(name, size(name));
    return k_.named(name, camera(name));
  }

 private:
  Int made(int axis) {
    Int& value = made_[static_cast<size_t>(axis)];
    if (value.builder == nullptr) {
      value = image_size(k_, image_word::made, axis == 0 ? image_word::width : image_word::height);
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
    const Int frame(k_.b, k_.b.constant(0));
    const auto vector = [&](int i) { return k_.load3(FrameBuffer::frame, frame, word + 3 * i); };
    const Vec3 across = vector(1) * functions::splat<3>(from_middle(0));
    const Vec3 down = vector(2) * functions::splat<3>(from_middle(1));
    return ((vector(0) + across) + down).value;
  }

  ir::ValueId varying(const std::string& name) {
    if (name == "pixel") return Vec2(centre(0), centre(1)).value;
    if (name == "coordinate") return Vec2(coordinate(0), coordinate(1)).value;
    if (name == "view_ray") return over_screen(frame_word::view_ray);
    if (name == "relative_origin") return over_screen(frame_word::ray_origin);
    const size_t end = name.rfind('_');
    const Spot& spot = spot_in(image_of(name.substr(0, end)));
    if (name.substr(end) == "_inside") return Vec2(spot.inside[0], spot.inside[1]).value;
    return spot.pixel[name.back() == 'x' ? 0 : 1].value;
  }

  ir::ValueId size(const std::string& name) {
    if (name == "screen") return Vec2(to_float(made(0)), to_float(made(1))).value;
    const size_t end = name.rfind('_');
    const bool is_width = name.substr(end) == "_width";
    return image_size(k_, image_of(name.substr(0, end)), is_width ? image_word::width : image_word::height)
        .value;
  }

  ir::ValueId camera(const std::string& name) {
    const Int frame(k_.b, k_.b.constant(0));
    const auto word = [&](int at) { return k_.load(FrameBuffer::frame, Int(k_.b, k_.b.constant(at))); };
    if (name == "position") return k_.load3(FrameBuffer::frame, frame, frame_word::camera_position).value;
    if (name == "direction") return k_.load3(FrameBuffer::frame, frame, frame_word::camera_direction).value;
    const int first = name == "depth_numerator" ? frame_word::depth_numerator : frame_word::depth_denominator;
    return Vec2(word(first), word(first + 1)).value;
  }

  int image_of(const std::string& prefix) const {
    if (prefix == depth_prefix) return image_word::depth;
    for (size_t i = 0; i < images_.size(); ++i)
      if (images_[i] == prefix) return image_word::color + static_cast<int>(i);
    support::bug("a post has no image " + prefix);
  }

  struct Spot {
    int image;
    std::vector<Int> pixel;
    std::vector<Float> inside;
  };
  const Spot& spot_in(int image) {
    for (const Spot& spot : spots_)
      if (spot.image == image) return spot;
    const uint32_t under = add_under(k_.b.module());
    Spot spot{image, {}, {}};
    for (const int axis : {0, 1}) {
      const Int read = image_size(k_, image, axis == 0 ? image_word::width : image_word::height);
      const std::array arguments{k_.b.parameter(static_cast<size_t>(axis)), made(axis).value, read.value};
      const std::vector<ir::ValueId> results = k_.b.call(under, arguments);
      spot.pixel.emplace_back(k_.b, results[0]);
      spot.inside.emplace_back(k_.b, results[1]);
    }
    spots_.push_back(std::move(spot));
    return spots_.back();
  }

  Kernel& k_;
  const std::vector<std::string>& images_;
  std::array<Int, 2> made_{Int(0), Int(0)};
  std::vector<Spot> spots_;
};

}  // namespace

uint32_t add_post_kernel(ir::Module& module, const std::vector<std::string>& images,
                         const FieldOffsets& record) {
  const auto define = [&](const std::string& name, int image) {
    if (const uint32_t function = module.find(name); function != ir::none)
      define_read(module, function, image);
  };
  define(std::string(depth_prefix) + "_at", image_word::depth);
  for (size_t i = 0; i < images.size(); ++i)
    define(images[i] + "_at", image_word::color + static_cast<int>(i));
  const uint32_t post_process = module.find(post_name);
  support::assert_that(post_process != ir::none, "no post_process");

  Kernel k(module, "post", {int_parameter("x"), uniform_int("y")}, {{"color", ir::vector_type(4)}});
  ScreenPoint screen(k, images);
  const Int first(k.b, k.b.constant(0));
  std::vector<ir::ValueId> arguments;
  const std::vector<ir::Parameter> wanted = module.functions[post_process].parameters;
  for (const ir::Parameter& parameter : wanted) {
    if (parameter.group == "frame") {
      const Int time(k.b, k.b.constant(frame_word::time));
      arguments.push_back(k.named(parameter.name, k.load(FrameBuffer::frame, time)).value);
    } else if (parameter.group == "parameters" || parameter.group == taps_group) {
      const std::string key = parameter.group == taps_group ? tap_field(parameter.name) : parameter.name;
      int offset = -1;
      for (const auto& [name, word] : record)
        if (name == key) offset = word;
      support::assert_that(offset >= 0, key);
      arguments.push_back(k.named(parameter.name, load_field(k, parameter.type, first, offset)));
    } else {
      arguments.push_back(screen.field(parameter));
    }
  }
  k.b.finish(k.b.call(post_process, arguments));
  return k.index;
}

}  // namespace isoshade::lower
