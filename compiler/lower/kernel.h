// SPDX-License-Identifier: Apache-2.0
// Kernels under construction: the function library's types over a builder, and loads by frame_layout.h.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "compiler/functions/all.h"
#include "compiler/functions/calls.h"
#include "compiler/functions/interpolation.h"
#include "compiler/interface/binding.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/support/assert.h"

namespace isoshade::lower {

using functions::traced::Bool;
using functions::traced::Float;
using functions::traced::Int;
using Vec2 = lanes::vec<Float, 2>;
using Vec3 = lanes::vec<Float, 3>;
using Vec4 = lanes::vec<Float, 4>;

/// A kernel under construction.
class Kernel {
 public:
  Kernel(ir::Module& module, std::string name, std::vector<ir::Parameter> parameters,
         std::vector<ir::Result> results)
      : index(new_function(module, std::move(name), std::move(parameters), std::move(results))),
        b(module, index) {}
  /// The body of a function that is declared.
  Kernel(ir::Module& module, uint32_t declared) : index(declared), b(module, declared) {}

  Int constant(int value) { return Int(b, b.constant(value)); }
  Int integer(size_t parameter) { return Int(b, b.parameter(parameter)); }
  Vec3 vector3(size_t parameter) { return Vec3(b, b.parameter(parameter)); }
  Vec4 vector4(size_t parameter) { return Vec4(b, b.parameter(parameter)); }

  /// Where words of records come from that are in no buffer: gives so many, from `word` of a record on.
  using Words = std::function<ir::ValueId(FrameBuffer buffer, int word, int width)>;
  /// From here on, all that reads a word of a record asks `words` for it.
  void read_words_from(Words words) { words_ = std::move(words); }

  Float load(FrameBuffer buffer, Int word) {
    return Float(b, b.load(static_cast<uint32_t>(buffer), word.id(b)));
  }
  Int load_int(FrameBuffer buffer, Int word) {
    return Int(b, b.load(static_cast<uint32_t>(buffer), word.id(b)));
  }
  /// One, three or four words of a record, from `record + word` on.
  Float load(FrameBuffer buffer, Int record, int word) {
    return words_ ? Float(b, words_(buffer, word, 1)) : load(buffer, record + Int(word));
  }
  Int load_int(FrameBuffer buffer, Int record, int word) {
    return words_ ? Int(b, words_(buffer, word, 1)) : load_int(buffer, record + Int(word));
  }
  Vec3 load3(FrameBuffer buffer, Int record, int word) {
    if (words_) return Vec3(b, words_(buffer, word, 3));
    const auto at = [&](int i) { return load(buffer, record + Int(word + i)); };
    return Vec3(at(0), at(1), at(2));
  }
  Vec4 load4(FrameBuffer buffer, Int record, int word) {
    if (words_) return Vec4(b, words_(buffer, word, 4));
    const auto at = [&](int i) { return load(buffer, record + Int(word + i)); };
    return Vec4(at(0), at(1), at(2), at(3));
  }

  /// Gives a value a name for readers of the emitted text.
  ir::ValueId named(std::string name, ir::ValueId value) {
    b.name(value, b.add_origin(std::move(name), 0));
    return value;
  }
  template <class T>
  T named(std::string name, T value) {
    named(std::move(name), value.value);
    return value;
  }

  std::vector<ir::ValueId> call(std::string_view function, std::initializer_list<ir::ValueId> arguments) {
    const uint32_t callee = b.module().find(function);
    support::assert_that(callee != ir::none, function);
    return b.call(callee, std::span(arguments));
  }

  const uint32_t index;
  ir::Builder b;

 private:
  static uint32_t new_function(ir::Module& module, std::string name, std::vector<ir::Parameter> parameters,
                               std::vector<ir::Result> results) {
    support::assert_that(module.find(name) == ir::none, name);
    ir::Function function;
    function.name = std::move(name);
    function.parameters = std::move(parameters);
    function.results = std::move(results);
    module.functions.push_back(std::move(function));
    return static_cast<uint32_t>(module.functions.size() - 1);
  }

  Words words_;
};

/// Where a column of an input begins in its record.
int column_word(const interface::RecordLayout& record, const interface::source::Input& input, ir::Type column);
/// A value of the type in `objects`: floats, also for booleans (0, 1) and integers.
ir::ValueId load_field(Kernel& k, ir::Type type, Int record, int offset);

/// How far a point has moved, in pixels: `from_middle` is where it is, -1 to 1 over the picture, y up; `w` and `change` are
/// its w in clip space, and how much x, y and w have changed there. `half_size`: of the picture, y negative.
Vec2 moved_pixels(Kernel& k, Vec2 from_middle, Float w, Vec3 change, Vec2 half_size);

inline ir::Parameter int_parameter(std::string name) { return {std::move(name), ir::int_type, "", false}; }
inline ir::Parameter uniform_int(std::string name) { return {std::move(name), ir::int_type, "", true}; }

/// Sums `columns` weighted by the components of `v`, in order.
template <class Column>
Column weighted(const std::array<Column, 3>& columns, Vec3 v) {
  constexpr int n = std::is_same_v<Column, Vec4> ? 4 : 3;
  return (columns[0] * functions::splat<n>(v[0]) + columns[1] * functions::splat<n>(v[1])) +
         columns[2] * functions::splat<n>(v[2]);
}

}  // namespace isoshade::lower
