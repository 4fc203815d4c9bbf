// SPDX-License-Identifier: Apache-2.0
#include "compiler/interface/host.h"

#include <array>

#include "compiler/support/assert.h"

namespace isoshade::interface {
namespace {

constexpr std::array<HostRow, host_call_count> rows{{
#define HOST(name, result, parameters, doc) {#name, #result, parameters, doc},
#include "compiler/interface/host.def"
}};

/// 0 for the image that a post goes over, 1, 2, ... for those that it lists.
int picture_number(ImageNumber image) { return static_cast<int>(image) - image_record::color; }

HostCall call_of(SpaceMatrix matrix) {
  switch (matrix) {
    case SpaceMatrix::world_from_object: return HostCall::world_from_object;
    case SpaceMatrix::object_from_world: return HostCall::object_from_world;
    case SpaceMatrix::view_from_world: return HostCall::view_from_world;
    case SpaceMatrix::world_from_view: return HostCall::world_from_view;
  }
  support::bug("no such matrix");
}

Place place_of(Screen value) {
  switch (value) {
    case Screen::pixel:
    case Screen::coordinate:
    case Screen::view_ray:
    case Screen::relative_origin: return place::Point{};
    case Screen::size: return place::Host{HostCall::screen_size};
    case Screen::camera_position: return place::Host{HostCall::camera_position};
    case Screen::camera_direction: return place::Host{HostCall::camera_direction};
    case Screen::depth_numerator: return place::Host{HostCall::depth_numerator};
    case Screen::depth_denominator: return place::Host{HostCall::depth_denominator};
  }
  support::bug("no such value of the screen");
}

}  // namespace

const HostRow& row(HostCall call) { return rows[static_cast<size_t>(call)]; }

std::optional<Answer> answer_of(const HostFunction& function) {
  switch (function.host) {
    case Host::light: return Answer{HostCall::light};
    case Host::light_change: return Answer{HostCall::light_change};
    case Host::environment: return Answer{HostCall::environment};
    case Host::irradiance: return Answer{HostCall::irradiance};
    case Host::texel: return Answer{HostCall::texel};
    case Host::texture_size: return Answer{HostCall::image_size};
    case Host::texture_layer: return Answer{HostCall::image_layer};
    case Host::image: return Answer{HostCall::picture, picture_number(function.image)};
    case Host::depth: return Answer{HostCall::depth};
    case Host::mip_level:
    case Host::sample_closest:
    case Host::sample_linear:
    case Host::sample_trilinear: return std::nullopt;
  }
  support::bug("no such function of a host");
}

Place place_of(const Binding& binding, bool in_function) {
  const auto size = [](const source::SizeOfImage& s) {
    const bool is_width = s.axis == Axis::x;
    if (s.image == static_cast<ImageNumber>(image_record::depth))
      return place::Host{is_width ? HostCall::depth_width : HostCall::depth_height};
    return place::Host{is_width ? HostCall::picture_width : HostCall::picture_height,
                       picture_number(s.image)};
  };
  return std::visit(
      Cases{
          [](const source::Attribute&) { return Place(place::Point{}); },
          [](const source::MatrixColumn& s) {
            return Place(place::Host{call_of(s.matrix), static_cast<int>(s.column)});
          },
          [](const source::Time&) { return Place(place::Host{HostCall::time}); },
          [](const source::PassRepetition& s) {
            return Place(place::Host{s.what == Repetition::index ? HostCall::pass_index : HostCall::pass_count});
          },
          [&](const source::Input&) {
            return in_function ? Place(place::Argument{}) : Place(place::Parameter{});
          },
          [&](const source::Image&) {
            return in_function ? Place(place::Argument{}) : Place(place::Parameter{});
          },
          [](const source::LightCount&) { return Place(place::Host{HostCall::light_count}); },
          [](const source::FirstLight&) -> Place { support::bug("only kernels list lights"); },
          [](const source::HasEnvironment&) { return Place(place::Host{HostCall::has_environment}); },
          [](const source::ScreenValue& s) { return place_of(s.value); },
          [](const source::PixelOfImage&) { return Place(place::Point{}); },
          [](const source::OffsetInPixel&) { return Place(place::Point{}); },
          [&](const source::SizeOfImage& s) { return Place(size(s)); },
          [&](const source::TapCount&) { return Place(place::Known{static_cast<int>(binding.assumed.lo)}); },
      },
      binding.source);
}

}  // namespace isoshade::interface
