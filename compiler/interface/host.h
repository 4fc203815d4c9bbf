// SPDX-License-Identifier: Apache-2.0
// What a pure shader is given and what it asks for: how each binding of a document's function is written in a text that
// other programs link.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "compiler/interface/binding.h"

namespace isoshade::interface {

/// What a shader asks of its host, by the rows of host.def.
enum class HostCall : uint8_t {
#define HOST(name, result, parameters, doc) name,
#include "compiler/interface/host.def"
};

#define HOST(name, result, parameters, doc) +1
inline constexpr size_t host_call_count = 0
#include "compiler/interface/host.def"
    ;

struct HostRow {
  std::string_view name;
  std::string_view result;      ///< a type of GLSL, "Light" or "ImageSize"
  std::string_view parameters;  ///< as in GLSL
  std::string_view doc;

  bool returns_record() const { return result == "Light" || result == "ImageSize"; }
};
const HostRow& row(HostCall call);

/// The function that answers a HostFunction of a module, and the image that it is asked for, or -1.
struct Answer {
  HostCall call;
  int image = -1;
};
/// Nothing for functions that lowering gives a body (samplers).
std::optional<Answer> answer_of(const HostFunction& function);

/// Where a pure shader finds the value of a binding.
namespace place {
/// A field of the struct that the caller fills for each point: Surface, Vertex or Screen.
struct Point {};
/// A field of the struct Parameters.
struct Parameter {};
/// An argument of a function document: an input, or the number of an image.
struct Argument {};
/// What the host answers: a call with at most one integer.
struct Host {
  HostCall call;
  int argument = -1;  ///< none if negative
};
/// A number that the shader itself knows.
struct Known {
  int value;
};
}  // namespace place
using Place = std::variant<place::Point, place::Parameter, place::Argument, place::Host, place::Known>;
/// `in_function`: of a function document.
Place place_of(const Binding& binding, bool in_function);

}  // namespace isoshade::interface
