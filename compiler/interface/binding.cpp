// SPDX-License-Identifier: Apache-2.0
#include "compiler/interface/binding.h"

#include <algorithm>
#include <array>

namespace isoshade::interface {
namespace {

using enum SurfaceStages;
using namespace assume;

constexpr std::array<SurfaceRow, surface_count> surface_rows{{
#define SURFACE(name, node, width, spaces, stages, assumed, sets, doc) \
  {#name, #node, width, spaces, stages, assumed, sets, doc},
#include "compiler/interface/values.def"
}};
constexpr std::array<ScreenRow, screen_value_count> screen_rows{{
#define SCREEN(name, group, parameter, width, assumed, doc) {#group, #parameter, width, assumed, doc},
#include "compiler/interface/values.def"
}};
constexpr std::array<std::string_view, space_matrix_count> matrix_names{{
#define MATRIX(name) #name,
#include "compiler/interface/values.def"
}};
constexpr std::string_view space_suffixes[space_count] = {"", "_object", "_view"};

const char* suffix(Axis axis, const char* of_x, const char* of_y) { return axis == Axis::x ? of_x : of_y; }

}  // namespace

const SurfaceRow& row(Surface attribute) { return surface_rows[static_cast<size_t>(attribute)]; }

uint32_t sets_of(Surface attribute) {
  const auto first = static_cast<size_t>(attribute);
  size_t end = first + 1;
  while (end < surface_count && surface_rows[end].node == surface_rows[first].node) ++end;
  return static_cast<uint32_t>(end - first);
}

const ScreenRow& row(Screen value) { return screen_rows[static_cast<size_t>(value)]; }

std::string name(SurfaceValue value) {
  return std::string(row(value.attribute).name) +
         std::string(space_suffixes[static_cast<size_t>(value.space)]);
}

const std::vector<SurfaceValue>& surface_values() {
  static const std::vector<SurfaceValue> all = [] {
    std::vector<SurfaceValue> made;
    for (size_t i = 0; i < surface_count; ++i) {
      const auto attribute = static_cast<Surface>(i);
      for (size_t space = 0; space < (row(attribute).has_spaces ? space_count : 1); ++space)
        made.push_back({attribute, static_cast<Space>(space)});
    }
    return made;
  }();
  return all;
}

Binding bind(SurfaceValue value) {
  const SurfaceRow& attribute = row(value.attribute);
  return {source::Attribute{value},
          {name(value), attribute.type(), "surface", false},
          attribute.assumed};
}

Binding bind(SpaceMatrix matrix, uint32_t column) {
  const std::string parameter =
      std::string(matrix_names[static_cast<size_t>(matrix)]) + "_" + std::to_string(column);
  return {source::MatrixColumn{matrix, column}, {parameter, ir::vector_type(3), "spaces", true}, anywhere};
}

Binding bind(Screen value) {
  const ScreenRow& screen = row(value);
  const std::string group(screen.group);
  return {source::ScreenValue{value},
          {std::string(screen.parameter), ir::vector_type(screen.width), group, group != "screen"},
          screen.assumed};
}

Binding bind_time() { return {source::Time{}, {"time", ir::float_type, "frame", true}, distance}; }

Binding bind_repetition(Repetition what, Assumption assumed) {
  const char* const name = what == Repetition::index ? "pass_index" : "pass_count";
  return {source::PassRepetition{what}, {name, ir::int_type, "", true}, assumed};
}

Binding bind_light_count() {
  return {source::LightCount{}, {"light_count", ir::int_type, "", true}, light_count};
}

Binding bind_first_light() { return {source::FirstLight{}, {"first_light", ir::int_type, "", true}, distance}; }

Binding bind_has_environment() {
  return {source::HasEnvironment{}, {"has_environment", ir::bool_type, "frame", true}, boolean};
}

Binding bind_image(uint32_t slot, std::string slot_name) {
  return {source::Image{slot}, {std::move(slot_name), ir::int_type, "images", true}, texture};
}

Binding bind_pixel(ImageNumber image, const std::string& prefix, Axis axis) {
  return {source::PixelOfImage{image, axis},
          {prefix + suffix(axis, "_x", "_y"), ir::int_type, "screen", false},
          image_place};
}

Binding bind_offset(ImageNumber image, const std::string& prefix) {
  return {source::OffsetInPixel{image}, {prefix + "_inside", ir::vector_type(2), "screen", false}, fraction};
}

Binding bind_size(ImageNumber image, const std::string& prefix, Axis axis) {
  return {source::SizeOfImage{image, axis},
          {prefix + suffix(axis, "_width", "_height"), ir::int_type, "sizes", true},
          image_size};
}

Binding bind_taps(uint32_t node, std::string node_name, int count) {
  const auto taps = static_cast<double>(count);
  return {source::TapCount{node}, {std::move(node_name), ir::int_type, "taps", true}, {taps, taps}};
}

const HostFunction* Interface::find(uint32_t function) const {
  const auto found = std::ranges::find(host, function, &HostFunction::function);
  return found == host.end() ? nullptr : &*found;
}

uint32_t Interface::find(Host wanted, ImageNumber image) const {
  for (const HostFunction& f : host)
    if (f.host == wanted && f.image == image) return f.function;
  return ir::none;
}

bool is_kernel_function(std::string_view name) {
  constexpr std::string_view all[] = {
#define KERNEL_FUNCTION(name) #name,
#include "compiler/interface/kernel_functions.def"
  };
  return std::ranges::find(all, name) != std::end(all);
}

}  // namespace isoshade::interface
