// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/parameters.h"

#include <algorithm>
#include <array>
#include <span>

#include "compiler/graph/files.h"
#include "compiler/support/assert.h"
#include "compiler/support/visible.h"
#include "runtime/scene/host_math.h"

namespace isoshade::render {

using graph::Literal;
using graph::Type;
using support::Diagnostics;
using support::Id;
using support::quote;

namespace {

/// A field of the record by name, with the word where it begins.
struct Found {
  const driver::Field* field = nullptr;
  Type type = Type::floating;
  size_t first_word = 0;
};

std::optional<Found> find_field(const driver::Effect& effect, const std::string& name) {
  size_t word = 0;
  for (const driver::Field& field : effect.parameters) {
    if (field.name == name) {
      const std::optional<Type> type = graph::find_type(field.type);
      support::assert_that(type.has_value(), "a parameter of a type that does not exist");
      return Found{&field, *type, word};
    }
    word += static_cast<size_t>(field.words);
  }
  return std::nullopt;
}

void report_unknown(const scene::Object& object, const driver::Effect& effect, const std::string& name,
                    const support::Span& where, Diagnostics& diagnostics) {
  std::vector<std::string_view> names;
  std::string list;
  for (const driver::Field& field : effect.parameters) {
    names.push_back(field.name);
    list.append(list.empty() ? "" : ", ").append(field.name);
  }
  support::Diagnostic& report = diagnostics.report_unknown(
      Id::unknown_parameter, where,
      "the effect of " + quote(object.name) + " has no parameter " + quote(name), name, names);
  if (report.fix.empty()) report.note(list.empty() ? "it has none at all" : "it has " + list);
}

/// Whether every number of a value lies where the effect allows it.
bool check_range(const driver::Field& field, Type type, const Literal& literal, const support::Span& where,
                 Diagnostics& diagnostics) {
  std::vector<float> numbers = literal.numbers;
  if (literal.kind == Literal::Kind::number) numbers = {literal.number};
  for (float number : numbers) {
    const bool below = field.min && number < *field.min;
    if (!below && !(field.max && number > *field.max)) continue;
    const std::string fault = !field.names.empty() ? " has no value " + graph::limit_text(type, number)
                              : below              ? " is at least " + graph::limit_text(type, *field.min)
                                                   : " is at most " + graph::limit_text(type, *field.max);
    support::Diagnostic& report =
        diagnostics.report(Id::out_of_range, where, "the parameter " + quote(field.name) + fault);
    if (!field.names.empty()) report.note(graph::described_names(field.names));
    return false;
  }
  return true;
}

std::string listed(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list.append(list.empty() ? "" : ", ").append(name);
  return list;
}

bool check_fit(const Found& found, const Literal& literal, const support::Span& where,
               Diagnostics& diagnostics) {
  const Type type = found.type;
  const std::string& name = found.field->name;
  const std::vector<std::string>& values = found.field->names;
  if (literal.kind == Literal::Kind::string && !values.empty()) {
    if (graph::named_value(values, literal.string)) return true;
    std::vector<std::string_view> names(values.begin(), values.end());
    diagnostics
        .report_unknown(Id::unknown_choice, where,
                        "no value of the parameter " + quote(name) + " is called " + quote(literal.string),
                        literal.string, names)
        .note(graph::described_names(values));
    return false;
  }
  if (graph::fits(type, literal)) return check_range(*found.field, type, literal, where, diagnostics);
  const int floats = graph::float_count(type);
  std::string expected = std::string(graph::type_name(type));
  if (type == Type::filename) expected += ", a path in quotes";
  if (type == Type::boolean) expected += ", true or false";
  if (type == Type::integer) expected += ", a whole number without fraction";
  if (floats == 1) expected += ", a number";
  if (!values.empty()) expected += ", or one of " + listed(values);
  if (floats > 1) expected += ", an array of " + std::to_string(floats) + " numbers";
  diagnostics.report(Id::wrong_type, where, "the parameter " + quote(name) + " is of type " + expected);
  return false;
}

/// `names`: of an integer's values.
void store(Type type, const std::vector<std::string>& names, const Literal& literal, float* words) {
  switch (type) {
    case Type::boolean: words[0] = literal.boolean ? 1.0f : 0.0f; break;
    case Type::integer: {
      const auto named = graph::named_value(names, literal.string);
      words[0] = static_cast<float>(named ? named->integer : literal.integer);
      break;
    }
    case Type::floating: words[0] = literal.number; break;
    case Type::filename:
    case Type::string: break;  // not in the record
    default: std::copy(literal.numbers.begin(), literal.numbers.end(), words);
  }
}

/// The first numbers of `factors`, held in the parameter's range, if the effect has a parameter that takes
/// them.
void store_factors(const driver::Effect& effect, const std::string& name, std::span<const float> factors,
                   std::vector<float>& words) {
  const auto found = find_field(effect, name);
  if (!found) return;
  const auto count = static_cast<size_t>(std::max(graph::float_count(found->type), 0));
  const bool takes_them = factors.size() == 1 ? count == 1 : count == 3 || count == factors.size();
  if (!takes_them) return;
  for (size_t i = 0; i < count; ++i) {
    float value = factors[i];
    if (found->field->min) value = std::max(value, *found->field->min);
    if (found->field->max) value = std::min(value, *found->field->max);
    words[found->first_word + i] = value;
  }
}

/// A path that a value has, from where the document lies that has it.
std::string path_of(const Literal& literal, const support::Span& where) {
  if (literal.string.empty() || where.file == nullptr) return literal.string;
  return graph::path_beside(where.file->path(), literal.string);
}

}  // namespace

bool ObjectParameters::resolve_image(const scene::Object& object, const driver::Image& image,
                                     const scene::GltfMaterial* material, const FindTexture& find_texture) {
  const std::string& name = image.slot.parameter;
  const auto find = [&](const ImageSource& source) {
    return source.path.empty() ? std::optional(-1) : find_texture(source, image.slot);
  };
  for (size_t axis = 0; axis < object.repeat.size() && !name.empty(); ++axis) {
    for (const scene::Variation& variation : object.repeat[axis].variations) {
      if (variation.name != name) continue;
      VaryingImage varying{axis, images_.size(), {}};
      for (const Literal& value : variation.values) {
        const auto texture = find({path_of(value, variation.value_where), nullptr, variation.value_where});
        if (!texture) return false;
        varying.textures.push_back(*texture);
      }
      varying_images_.push_back(std::move(varying));
      images_.push_back(-1);
      return true;
    }
  }
  ImageSource source{image.file, nullptr, image.where};
  if (material != nullptr && material->textures.contains(name)) {
    const scene::GltfImage& own = material->textures.at(name);
    source = {own.name, own.bytes, object.mesh_where, own.srgb};
  }
  for (const scene::Parameter& parameter : object.parameters) {
    if (name.empty() || parameter.name != name) continue;
    source = {path_of(parameter.value, parameter.value_where), nullptr, parameter.value_where};
  }
  const auto texture = find(source);
  images_.push_back(texture.value_or(-1));
  return texture.has_value();
}

std::optional<ObjectParameters> ObjectParameters::resolve(const scene::Object& object,
                                                          const driver::Effect& effect,
                                                          const scene::GltfMaterial* material,
                                                          const FindTexture& find_texture,
                                                          Diagnostics& diagnostics) {
  const size_t errors_before = diagnostics.error_count();
  ObjectParameters result;
  for (const driver::Field& field : effect.parameters)
    result.common_.insert(result.common_.end(), field.value.begin(), field.value.end());
  if (material != nullptr) {
    store_factors(effect, "base_color", material->base_color, result.common_);
    store_factors(effect, "metallic", std::array{material->metallic}, result.common_);
    store_factors(effect, "roughness", std::array{material->roughness}, result.common_);
    store_factors(effect, "emissive_color", material->emissive_color, result.common_);
    store_factors(effect, "normal_scale", std::array{material->normal_scale}, result.common_);
    store_factors(effect, "occlusion_strength", std::array{material->occlusion_strength}, result.common_);
  }

  for (const scene::Parameter& parameter : object.parameters) {
    if (diagnostics.full()) break;
    const auto found = find_field(effect, parameter.name);
    if (!found) {
      report_unknown(object, effect, parameter.name, parameter.name_where, diagnostics);
    } else if (check_fit(*found, parameter.value, parameter.value_where, diagnostics)) {
      store(found->type, found->field->names, parameter.value, result.common_.data() + found->first_word);
    }
  }
  for (size_t axis = 0; axis < object.repeat.size(); ++axis) {
    const std::vector<scene::Variation>& variations = object.repeat[axis].variations;
    for (size_t i = 0; i < variations.size() && !diagnostics.full(); ++i) {
      const scene::Variation& variation = variations[i];
      const auto found = find_field(effect, variation.name);
      if (!found) {
        report_unknown(object, effect, variation.name, variation.name_where, diagnostics);
        continue;
      }
      for (const Literal& value : variation.values)
        if (!check_fit(*found, value, variation.value_where, diagnostics)) break;
      if (found->type == Type::filename) continue;
      if (!variation.listed && found->type == Type::integer) {
        diagnostics.report(Id::wrong_type, variation.value_where,
                           "the parameter " + quote(variation.name) + " is an integer: list its values");
      }
      result.varying_.push_back({axis, i, found->type, found->field->names, found->first_word});
    }
  }
  if (diagnostics.error_count() != errors_before) return std::nullopt;
  for (const driver::Image& image : effect.images)
    if (!result.resolve_image(object, image, material, find_texture)) return std::nullopt;
  return result;
}

std::vector<float> ObjectParameters::words(const scene::Object& object, const scene::Instance& instance,
                                           const std::function<int(int)>& record_of) const {
  std::vector<float> words = common_;
  for (const Varying& varying : varying_) {
    const scene::Repeat& repeat = object.repeat[varying.axis];
    const Literal value = scene::variation_value(repeat.variations[varying.variation],
                                                 instance.place[varying.axis], repeat.count);
    store(varying.type, varying.names, value, words.data() + varying.first_word);
  }
  for (float& word : words) word = scene::canonical(word);
  std::vector<int> textures = images_;
  for (const VaryingImage& varying : varying_images_)
    textures[varying.image] = varying.textures[static_cast<size_t>(instance.place[varying.axis])];
  for (const int texture : textures) words.push_back(static_cast<float>(record_of(texture)));
  return words;
}

}  // namespace isoshade::render
