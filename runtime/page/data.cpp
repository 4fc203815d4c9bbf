// SPDX-License-Identifier: Apache-2.0
#include "runtime/page/data.h"

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>

#include "compiler/emit/forward.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/support/assert.h"
#include "runtime/page/encode.h"

namespace isoshade::page {
namespace {

using nlohmann::ordered_json;

/// The first word of a part of a record, and how many there are, by the part's name.
using Layout = std::initializer_list<std::pair<const char*, std::array<int, 2>>>;
ordered_json layout_of(Layout parts) {
  ordered_json layout = ordered_json::object();
  for (const auto& [name, place] : parts) layout[name] = place;
  return layout;
}

ordered_json layouts() {
  ordered_json all{{"vertex_words", lower::vertex_word::stride}, {"object_words", lower::object_word::parameters},
                   {"most_lights", emit::most_forward_lights}};
  all["vertex"] = layout_of({
#define VERTEX(name, words) {#name, {lower::vertex_word::name, words}},
#include "compiler/interface/records.def"
  });
  all["object"] = layout_of({
#define OBJECT(name, words) {#name, {lower::object_word::name, words}},
#include "compiler/interface/records.def"
  });
  all["light"] = layout_of({
#define LIGHT(name, words) {#name, {lower::light_word::name, words}},
#include "compiler/interface/records.def"
  });
  all["view"] = layout_of({
#define VIEW(name, words) {#name, {lower::view_word::name, words}},
#include "compiler/interface/records.def"
  });
  return all;
}

ordered_json numbers(const glm::vec3& vector) { return {vector.x, vector.y, vector.z}; }

ordered_json camera_of(const scene::Camera& camera) {
  return {{"projection", scene::projection_names[static_cast<size_t>(camera.projection)]},
          {"position", numbers(camera.position)},
          {"target", numbers(camera.target)},
          {"up", numbers(camera.up)},
          {"fov", camera.fov},
          {"height", camera.height},
          {"near", camera.near},
          {"far", camera.far}};
}

ordered_json fields_of(const driver::ParameterBlock& block, const DocumentText& document) {
  ordered_json fields = ordered_json::array();
  for (size_t i = 0; i < block.fields.size(); ++i) {
    const driver::Field& field = block.fields[i];
    ordered_json row{{"name", field.name},
                     {"type", field.type},
                     {"word", block.word_of(i)},
                     {"words", field.words},
                     {"doc", document.docs[i]}};
    if (field.min) row["min"] = *field.min;
    if (field.max) row["max"] = *field.max;
    if (!field.names.empty()) row["names"] = field.names;
    fields.push_back(std::move(row));
  }
  return fields;
}

/// What the panel shows of an object or a post.
ordered_json owner(std::string_view name, const DocumentText& document, const driver::ParameterBlock& block,
                   std::span<const scene::Parameter> parameters, std::span<const float> values) {
  ordered_json files = ordered_json::object();
  for (const driver::Image& image : block.images)
    if (!image.slot.parameter.empty()) files[image.slot.parameter] = image.slot.path;
  for (const scene::Parameter& parameter : parameters)
    if (files.contains(parameter.name)) files[parameter.name] = parameter.value.string;
  return {{"name", name},
          {"effect", document.name},
          {"doc", document.doc},
          {"fields", fields_of(block, document)},
          {"varied", ordered_json::array()},
          {"files", files},
          {"values", values}};
}

ordered_json word_of(const driver::ParameterBlock& block, std::optional<size_t> field) {
  return field ? ordered_json(block.word_of(*field)) : ordered_json(nullptr);
}

class Data {
 public:
  explicit Data(const PageContent& content) : content_(content), plan_(content.plan) {
    for (const render::RecordOrigin& origin : plan_.origins) origins_[origin.record] = &origin;
  }

  std::string text() {
    const scene::Scene& scene = content_.scene;
    const backends::Frame& frame = plan_.frame;
    json_ = {{"name", scene.name},
             {"doc", doc_of_scene()},
             {"size", {scene.width, scene.height}},
             {"time", scene.time},
             {"background", scene.background},
             {"encoding", scene::encoding_names[static_cast<size_t>(scene.output.encoding)]},
             {"exposure", scene.output.exposure},
             {"camera", camera_of(scene.camera)},
             {"warnings", content_.warnings},
             {"reads_time", content_.shaders.reads_time},
             {"layouts", layouts()}};
    add_programs();
    add_draws();
    add_posts();
    add_textures();
    add_lights();
    json_["vertices"] = base64(std::span(std::as_const(frame.vertices)));
    json_["records"] = base64(std::span(std::as_const(frame.objects)));
    json_["texels"] = base64(std::span(std::as_const(frame.texels)));
    json_["texel_bytes"] = base64(std::span(std::as_const(frame.texel_bytes)));
    const backends::Image& reference = content_.reference;
    json_["reference"] = {{"width", reference.width},
                          {"height", reference.height},
                          {"view", std::span(content_.reference_plan.frame.picture().words)
                                       .first(lower::view_word::camera_words)},
                          {"rgba", base64(std::span(reference.rgba))}};
    return json_.dump(-1, ' ', true);
  }

 private:
  std::string doc_of_scene() const {
    support::Diagnostics unheard;
    const auto document = graph::parse_document(content_.scene.source, unheard);
    const graph::Json* doc = document ? document->root.find("doc") : nullptr;
    return doc != nullptr ? doc->string : std::string();
  }

  void add_programs() {
    json_["programs"] = ordered_json::array();
    for (const ProgramText& program : content_.shaders.programs)
      json_["programs"].push_back({{"name", program.name},
                                   {"vertex", program.vertex},
                                   {"fragment", program.fragment},
                                   {"parameters", program.parameters}});
  }

  /// The number of the effect that has the pass, and that of the pass.
  std::pair<size_t, size_t> number_of(const driver::EffectPass* pass) const {
    for (size_t e = 0; e < plan_.effects.size(); ++e) {
      const auto& passes = plan_.effects[e].passes;
      for (size_t p = 0; p < passes.size(); ++p)
        if (&passes[p] == pass) return {e, p};
    }
    support::bug("a record belongs to no pass");
  }

  /// The first of a part's indices in `indices`, where they are of the whole array of vertices.
  size_t first_index(const backends::Draw& draw) {
    const auto [found, is_new] = first_index_.try_emplace(draw.indices.data(), indices_.size());
    if (is_new)
      for (const uint32_t index : draw.indices) indices_.push_back(draw.first_vertex + index);
    return found->second;
  }

  std::span<const float> record(const backends::Draw& draw, const driver::ParameterBlock& block) const {
    return std::span(plan_.frame.objects)
        .subspan(static_cast<size_t>(draw.object + lower::object_word::parameters), block.word_count());
  }

  /// One owner for each object, and the draws in their order.
  void add_draws() {
    const scene::Scene& scene = content_.scene;
    ordered_json owners(scene.objects.size(), ordered_json());
    ordered_json draws = ordered_json::array();
    for (const backends::Draw& draw : plan_.frame.picture().draws) {
      const render::RecordOrigin& origin = *origins_.at(draw.object);
      const auto [e, p] = number_of(origin.pass);
      const driver::Effect& effect = plan_.effects[e];
      ordered_json row{{"owner", origin.object},
                       {"program", content_.shaders.passes[e][p]},
                       {"object", draw.object},
                       {"words", effect.parameters.word_count()},
                       {"images", effect.parameters.word_of_image(0)},
                       {"first", first_index(draw)},
                       {"count", draw.indices.size()},
                       {"enabled", word_of(effect.parameters, origin.pass->enabled)},
                       {"repeat", word_of(effect.parameters, origin.pass->repeat.parameter)},
                       {"double_sided", word_of(effect.parameters, origin.pass->double_sided)},
                       {"blended", word_of(effect.parameters, origin.pass->blended)},
                       {"mirrored", draw.mirrored}};
      for (const interface::PassStateRow& state : interface::pass_states())
        row[std::string(state.key)] = state.values[state.get(origin.pass->state)];
      draws.push_back(std::move(row));
      ordered_json& known = owners[origin.object];
      if (known.is_null()) known = object_owner(origin.object, e, record(draw, effect.parameters));
    }
    json_["owners"] = std::move(owners);
    json_["draws"] = std::move(draws);
    json_["indices"] = base64(std::span(std::as_const(indices_)));
  }

  ordered_json object_owner(size_t number, size_t effect, std::span<const float> values) const {
    const scene::Object& object = content_.scene.objects[number];
    ordered_json made = owner(object.name, content_.shaders.effects[effect], plan_.effects[effect].parameters,
                              object.parameters, values);
    for (const scene::Repeat& axis : object.repeat)
      for (const scene::Variation& variation : axis.variations) made["varied"].push_back(variation.name);
    return made;
  }

  /// The posts, all of which run. `over`: the image that takes the place of a post that is switched off. Images are
  /// numbered as in PostChain.
  void add_posts() {
    const scene::Scene& scene = content_.scene;
    json_["posts"] = ordered_json::array();
    for (const render::PostStep& step : plan_.posts.steps) {
      const scene::Post& post = scene.posts[step.post_number];
      const auto document = static_cast<size_t>(step.post - plan_.post_documents.data());
      int over = static_cast<int>(step.post_number);
      for (const scene::PostInput& input : post.inputs)
        if (input.image == graph::post_output) over = input.source + 1;
      json_["posts"].push_back({{"owner", json_["owners"].size()},
                                {"program", content_.shaders.post_programs[document]},
                                {"record", step.record},
                                {"size", post.size},
                                {"sources", step.sources},
                                {"over", over},
                                {"enabled", word_of(step.post->parameters, step.post->enabled)}});
      json_["owners"].push_back(owner(post.name, content_.shaders.posts[document], step.post->parameters,
                                      post.parameters, step.record));
    }
  }

  /// Each texture by the number of its record: its layers, each a list of mip levels.
  void add_textures() {
    namespace word = lower::texture_word;
    const std::vector<int32_t>& records = plan_.frame.textures;
    json_["textures"] = ordered_json::array();
    for (size_t first = 0; first < records.size();) {
      ordered_json texture{{"record", first / word::stride}, {"layers", ordered_json::array()}};
      for (int layers = records[first + word::layers]; layers > 0; --layers) {
        ordered_json levels = ordered_json::array();
        for (int left = records[first + word::smaller]; left >= 0; --left, first += word::stride)
          levels.push_back({{"first", records[first + word::first]},
                            {"width", records[first + word::width]},
                            {"height", records[first + word::height]},
                            {"table", records[first + word::table]}});
        texture["layers"].push_back(std::move(levels));
      }
      json_["textures"].push_back(std::move(texture));
    }
  }

  void add_lights() {
    const std::vector<float>& lights = plan_.frame.lights;
    json_["lights"] = ordered_json::array();
    for (size_t i = 0; i < lights.size(); i += lower::light_word::stride)
      json_["lights"].push_back(std::span(lights).subspan(i, lower::light_word::stride));
  }

  const PageContent& content_;
  const render::Plan& plan_;
  std::map<int, const render::RecordOrigin*> origins_;
  std::map<const uint32_t*, size_t> first_index_;
  std::vector<uint32_t> indices_;
  ordered_json json_;
};

}  // namespace

size_t array_bytes(const render::Plan& plan) {
  const backends::Frame& frame = plan.frame;
  size_t words = frame.vertices.size() + frame.objects.size() + frame.texels.size() + frame.texel_bytes.size();
  for (const render::StoredMesh& mesh : plan.meshes)
    for (const render::MeshPart& part : mesh.parts) words += part.indices.size();
  return base64_size(4 * words);
}

std::string page_data(const PageContent& content) { return Data(content).text(); }

}  // namespace isoshade::page
