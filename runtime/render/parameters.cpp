// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/parameters.h"

#include <algorithm>
#include <array>
#include <span>

#include "compiler/driver/parameter_value.h"
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

void report_unknown(const driver::ParameterBlock& block, std::string_view giver, const std::string& name,
                    const support::Span& where, Diagnostics& diagnostics) {
  std::vector<std::string_view> names;
  std::string list;
  for (const driver::Field& field : block.fields) {
    names.push_back(field.name);
    list.append(list.empty() ? "" : ", ").append(field.name);
  }
  support::Diagnostic& report = diagnostics.report_unknown(
      Id::unknown_parameter, where, "the effect of " + quote(giver) + " has no parameter " + quote(name),
      name, names);
  if (report.fix.empty()) report.note(list.empty() ? "it has no parameters" : "it has " + list);
}

/// Stores a factor of a material, held in the range of the field that takes it, if the block has such a field. Integers
/// and booleans take it if it is `whole`.
void store_factor(const driver::ParameterBlock& block, std::string_view name, std::span<const float> factor, bool whole,
                  std::vector<float>& words) {
  const auto number = block.find(name);
  if (!number) return;
  const driver::Field& field = block.fields[*number];
  const Type type = driver::type_of(field);
  const bool takes_whole = type == Type::boolean || type == Type::integer;
  const size_t count = takes_whole ? (whole ? 1 : 0) : static_cast<size_t>(std::max(graph::float_count(type), 0));
  const bool takes_it = factor.size() == 1 ? count == 1 : count == 3 || count == factor.size();
  if (!takes_it) return;
  for (size_t i = 0; i < count; ++i) {
    float value = factor[i];
    if (field.min) value = std::max(value, *field.min);
    if (field.max) value = std::min(value, *field.max);
    words[block.word_of(*number) + i] = value;
  }
}

/// Stores the value with this name, if the block has such a field and the field such a value.
void store_name(const driver::ParameterBlock& block, std::string_view parameter, std::string_view name,
                std::vector<float>& words) {
  const auto number = block.find(parameter);
  if (!number) return;
  if (const auto value = graph::named_value(block.fields[*number].names, name))
    words[block.word_of(*number)] = static_cast<float>(value->integer);
}

/// Paths are relative to the document that gives them.
std::string path_of(const Literal& literal, const support::Span& where) {
  if (literal.string.empty() || where.file == nullptr) return literal.string;
  return graph::path_beside(where.file->path(), literal.string);
}

}  // namespace

class ParameterValues::Resolver {
 public:
  Resolver(const driver::ParameterBlock& block, const ParameterGiver& giver, const FindTexture& find_texture,
           Diagnostics& diagnostics)
      : block_(block), giver_(giver), find_texture_(find_texture), diagnostics_(diagnostics) {
    values_.common_ = block.defaults();
    values_.first_image_word_ = block.word_of_image(0);
  }

  std::optional<ParameterValues> resolve() {
    const size_t errors_before = diagnostics_.error_count();
    for (const driver::Field& field : block_.fields)
      if (driver::type_of(field) == Type::integer && !field.value.empty())
        driver::check_integer(field, static_cast<int64_t>(field.value[0]), {}, diagnostics_);
    take_factors();
    take_parameters();
    take_variations();
    if (diagnostics_.error_count() != errors_before) return std::nullopt;
    for (const driver::Image& image : block_.images)
      if (!take_image(image)) return std::nullopt;
    return std::move(values_);
  }

 private:
  void take_factors() {
    const scene::Material* const material = giver_.material;
    if (material == nullptr) return;
    const auto store = [&](std::string_view name, std::span<const float> factor, bool whole = false) {
      store_factor(block_, name, factor, whole, values_.common_);
    };
    store("base_color", material->base_color);
    store("alpha", std::array{material->alpha});
    store("alpha_cutoff", std::array{material->alpha_cutoff});
    store("blended", std::array{material->blended ? 1.0f : 0.0f}, true);
    store("double_sided", std::array{material->double_sided ? 1.0f : 0.0f}, true);
    store("metallic", std::array{material->metallic});
    store("roughness", std::array{material->roughness});
    store("emissive_color", material->emissive_color);
    store("normal_scale", std::array{material->normal_scale});
    store("occlusion_strength", std::array{material->occlusion_strength});
    for (const auto& [name, value] : material->values) store(name, value, true);
    for (const auto& [parameter, name] : material->names) store_name(block_, parameter, name, values_.common_);
  }

  void take_parameters() {
    for (const scene::Parameter& parameter : giver_.parameters) {
      if (diagnostics_.full()) return;
      const auto number = find(parameter.name, parameter.name_where);
      if (!number) continue;
      const driver::Field& field = block_.fields[*number];
      if (!driver::check_fit(field, parameter.value, parameter.value_where, diagnostics_)) continue;
      driver::store(driver::type_of(field), field.names, parameter.value,
                    values_.common_.data() + block_.word_of(*number));
    }
  }

  void take_variations() {
    for (size_t axis = 0; axis < giver_.repeat.size(); ++axis) {
      const std::vector<scene::Variation>& variations = giver_.repeat[axis].variations;
      for (size_t i = 0; i < variations.size() && !diagnostics_.full(); ++i) {
        const scene::Variation& variation = variations[i];
        const auto number = find(variation.name, variation.name_where);
        if (!number) continue;
        const driver::Field& field = block_.fields[*number];
        for (const Literal& value : variation.values)
          if (!driver::check_fit(field, value, variation.value_where, diagnostics_)) break;
        const Type type = driver::type_of(field);
        if (type == Type::filename) continue;
        if (!variation.listed && type == Type::integer) {
          diagnostics_.report(Id::wrong_type, variation.value_where,
                              "the parameter " + quote(variation.name) + " is an integer: list its values");
        }
        values_.varying_.push_back(
            {axis, giver_.repeat[axis].count, variation, type, field.names, block_.word_of(*number)});
      }
    }
  }

  /// The field of the block, or a report that it has none.
  std::optional<size_t> find(const std::string& name, const support::Span& where) {
    const auto number = block_.find(name);
    if (!number) report_unknown(block_, giver_.name, name, where, diagnostics_);
    return number;
  }

  bool take_image(const driver::Image& image) {
    ImageWord& word = values_.images_.emplace_back();
    const std::string& name = image.slot.parameter;
    for (size_t axis = 0; axis < giver_.repeat.size() && !name.empty(); ++axis) {
      for (const scene::Variation& variation : giver_.repeat[axis].variations) {
        if (variation.name != name) continue;
        word.axis = axis;
        for (const Literal& value : variation.values) {
          const auto texture =
              texture_of({path_of(value, variation.value_where), nullptr, variation.value_where}, image);
          if (!texture) return false;
          word.along_axis.push_back(*texture);
        }
        return true;
      }
    }
    const auto texture = texture_of(source_of(image), image);
    word.texture = texture.value_or(-1);
    return texture.has_value();
  }

  ImageSource source_of(const driver::Image& image) const {
    const std::string& name = image.slot.parameter;
    if (!name.empty()) {
      for (const scene::Parameter& parameter : giver_.parameters)
        if (parameter.name == name)
          return {path_of(parameter.value, parameter.value_where), nullptr, parameter.value_where};
    }
    if (giver_.material != nullptr && giver_.material->textures.contains(name)) {
      const scene::MaterialImage& own = giver_.material->textures.at(name);
      return {own.name, own.bytes, giver_.material_where, own.srgb};
    }
    return {image.file, nullptr, image.slot.place};
  }

  std::optional<int> texture_of(const ImageSource& source, const driver::Image& image) const {
    return source.path.empty() ? std::optional(-1) : find_texture_(source, image.slot);
  }

  const driver::ParameterBlock& block_;
  const ParameterGiver& giver_;
  const FindTexture& find_texture_;
  Diagnostics& diagnostics_;
  ParameterValues values_;
};

std::optional<ParameterValues> ParameterValues::resolve(const driver::ParameterBlock& block,
                                                        const ParameterGiver& giver,
                                                        const FindTexture& find_texture,
                                                        Diagnostics& diagnostics) {
  return Resolver(block, giver, find_texture, diagnostics).resolve();
}

float ParameterValues::most(size_t word) const {
  std::optional<float> most;
  for (const Varying& varying : varying_) {
    if (varying.first_word != word) continue;
    for (const Literal& value : varying.variation.values) {
      float number = 0;
      driver::store(varying.type, varying.names, value, &number);
      most = std::max(most.value_or(number), number);
    }
  }
  return most.value_or(common_[word]);
}

driver::FixedWords ParameterValues::common() const {
  driver::FixedWords words;
  for (const float word : common_) words.emplace_back(scene::canonical(word));
  for (const Varying& varying : varying_)
    for (int i = 0; i < std::max(graph::float_count(varying.type), 1); ++i)
      words[varying.first_word + static_cast<size_t>(i)].reset();
  for (size_t i = 0; i < images_.size(); ++i) {
    std::optional<float>& word = words[first_image_word_ + i];
    word.reset();
    if (images_[i].along_axis.empty() && images_[i].texture < 0) word = -1.0f;
  }
  return words;
}

std::vector<float> ParameterValues::words(const scene::Instance& instance,
                                          const std::function<int(int)>& record_of) const {
  std::vector<float> words = common_;
  for (const Varying& varying : varying_) {
    const Literal value =
        scene::variation_value(varying.variation, instance.place[varying.axis], varying.count);
    driver::store(varying.type, varying.names, value, words.data() + varying.first_word);
  }
  for (float& word : words) word = scene::canonical(word);
  for (size_t i = 0; i < images_.size(); ++i) {
    const ImageWord& image = images_[i];
    const int texture = image.along_axis.empty()
                            ? image.texture
                            : image.along_axis[static_cast<size_t>(instance.place[image.axis])];
    words[first_image_word_ + i] = static_cast<float>(record_of(texture));
  }
  return words;
}

}  // namespace isoshade::render
