// SPDX-License-Identifier: Apache-2.0
#include "tests/names/documents.h"

#include <algorithm>

#include "compiler/check/library.h"
#include "tests/names/compilers.h"

namespace isoshade::names {
namespace {

/// The members of an object or the items of a list.
class List {
 public:
  void add(const std::string& item) { text_ += (text_.empty() ? "" : ",\n") + item; }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

std::string in_quotes(const std::string& word) { return '"' + word + '"'; }

/// The key of a node that is no port: it cannot give an input of this name.
bool is_key_of_nodes(const std::string& word) { return word == "type" || word == "doc" || word == "extras"; }

/// Adds all of the values, of which links are given: `n` nodes "sum_0" and so on; the link to the last.
std::string summed(List& nodes, const std::vector<std::string>& links, const std::string& name = "the_sum_") {
  std::string last = links[0];
  for (size_t i = 1; i < links.size(); ++i) {
    const std::string node = name + std::to_string(i);
    nodes.add(in_quotes(node) + R"(: {"type": "add", "in1": ")" + last + R"(", "in2": ")" + links[i] + "\"}");
    last = node;
  }
  return last;
}

class Compiler {
 public:
  Compiler() : library_("") { options_.library = &library_; }

  void add(const std::string& file, const std::string& members) {
    library_.add("odd/" + file + ".json", R"({"isoshade": 1, )" + members + "}");
  }
  void function(const std::string& members) {
    if (auto program = driver::compile_function(source(members), options_, diagnostics_))
      made_.programs.push_back(std::move(*program));
    shader(members);
  }
  /// Of passes beyond the first only the last is kept: the others have the same text but for its heading.
  void effect(const std::string& members) {
    auto effect = driver::compile_effect(source(members), options_, diagnostics_);
    if (!effect) return;
    if (effect->passes[0].moves_vertices) made_.programs.push_back(std::move(effect->passes[0].vertex));
    if (effect->passes[0].cutout) made_.programs.push_back(*std::move(effect->passes[0].cutout));
    made_.programs.push_back(std::move(effect->passes[0].pixel));
    if (effect->passes.size() > 1) made_.programs.push_back(std::move(effect->passes.back().pixel));
    shader(members);
  }
  void post(const std::string& members) {
    if (auto post = driver::compile_post(source(members), options_, diagnostics_))
      made_.programs.push_back(std::move(post->program));
    shader(members);
  }

  Made made() {
    if (diagnostics_.has_errors()) made_ = {};
    made_.messages = diagnostics_.text();
    return std::move(made_);
  }

 private:
  void shader(const std::string& members) {
    if (auto shader = driver::compile_shader(source(members), options_, {}, diagnostics_))
      made_.shaders.push_back(std::move(*shader));
  }
  static support::Source source(const std::string& members) {
    return std::make_shared<support::SourceFile>("odd/the_document.json",
                                                 R"({"isoshade": 1, )" + members + "}");
  }

  check::Library library_;
  driver::CompileOptions options_;
  support::Diagnostics diagnostics_;
  Made made_;
};

/// The parameters: floats, and of each of the other types some; what their sum is.
struct Parameters {
  List declared;
  List nodes;
  std::string sum;

  explicit Parameters(Chunk words) {
    List values;
    for (size_t i = 0; i < words.size() && i < 64; ++i) values.add(in_quotes(words[i]));
    std::vector<std::string> links;
    for (size_t i = 0; i < words.size(); ++i) {
      const std::string name = in_quotes(words[i]);
      const std::string made = "the_value_" + std::to_string(i);
      if (i % 8 == 3) {
        declared.add(name + R"(: {"type": "boolean", "value": true})");
        nodes.add(in_quotes(made) + R"(: {"type": "convert", "in": )" + name + R"(, "to": "float"})");
        links.push_back(made);
      } else if (i % 8 == 5) {
        declared.add(name + R"(: {"type": "integer", "enum": [)" + values.text() + R"(], "value": )" + name +
                     "}");
        nodes.add(in_quotes(made) + R"(: {"type": "convert", "in": )" + name + R"(, "to": "float"})");
        links.push_back(made);
      } else if (i % 8 == 7) {
        declared.add(name + R"(: {"type": "color3", "value": [0.1, 0.2, 0.3]})");
        links.push_back(words[i] + ".g");
      } else {
        declared.add(name + R"(: {"type": "float", "value": 0.5})");
        links.push_back(words[i]);
      }
    }
    sum = summed(nodes, links);
  }
};

const std::string grey = R"({"type": "combine3", "in1": "SUM", "in2": "SUM", "in3": "SUM", "to": "color3"})";
std::string grey_of(const std::string& sum) {
  std::string text = grey;
  for (size_t at; (at = text.find("SUM")) != std::string::npos;) text.replace(at, 3, sum);
  return text;
}

}  // namespace

Made functions_called(Chunk words) {
  Compiler compiler;
  List nodes;
  std::string last = "the_input";
  for (size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    const std::string name = in_quotes(word), inner = in_quotes(i == 0 ? "the_node" : words[i - 1]);
    const bool hidden = is_key_of_nodes(word);
    compiler.add(word, "\"function\": " + name + ", \"inputs\": {" + name + R"(: {"type": "float")" +
                           (hidden ? R"(, "value": 0.5)" : "") + "}}, \"nodes\": {" + inner +
                           R"(: {"type": "add", "in1": )" + name + R"(, "in2": 0.25}}, "outputs": {)" + name +
                           ": " + inner + "}");
    nodes.add(name + R"(: {"type": ")" + word + ".json\"" +
              (hidden ? "" : ", " + name + ": " + in_quotes(last)) + "}");
    last = word;
  }
  compiler.function("\"function\": " + in_quotes(words[0]) +
                    R"(, "inputs": {"the_input": {"type": "float"}}, "nodes": {)" + nodes.text() +
                    R"(}, "outputs": {"out": )" + in_quotes(last) + "}");
  return compiler.made();
}

Made function_of_many(Chunk words) {
  Compiler compiler;
  List inputs, nodes, outputs, given;
  std::vector<std::string> links;
  for (size_t i = 0; i < words.size(); ++i) {
    const std::string name = in_quotes(words[i]), node = "the_node_" + std::to_string(i);
    const bool hidden = is_key_of_nodes(words[i]);
    inputs.add(name + R"(: {"type": "float")" + (hidden ? R"(, "value": 0.5)" : "") + "}");
    if (!hidden) given.add(name + R"(: "the_input")");
    nodes.add(in_quotes(node) + R"(: {"type": "multiply", "in1": )" + name +
              ", \"in2\": " + in_quotes(words[(i + 1) % words.size()]) + "}");
    outputs.add(name + ": " + in_quotes(node));
    links.push_back("the_call." + words[i]);
  }
  const std::string many = R"("function": "many", "inputs": {)" + inputs.text() + R"(}, "nodes": {)" +
                           nodes.text() + R"(}, "outputs": {)" + outputs.text() + "}";
  compiler.add("many", many);
  compiler.function(many);
  List calling;
  calling.add(R"("the_call": {"type": "many.json")" + (given.text().empty() ? "" : ", " + given.text()) +
              "}");
  const std::string sum = summed(calling, links);
  compiler.function(R"("function": "caller", "inputs": {"the_input": {"type": "float"}}, "nodes": {)" +
                    calling.text() + R"(}, "outputs": {"out": )" + in_quotes(sum) + "}");
  return compiler.made();
}

Made nodes_called(Chunk words) {
  Compiler compiler;
  // Sums, and between them what becomes a call, a choice, several results or a loop.
  const auto chain = [&](std::string last, bool in_effect) {
    List nodes;
    for (size_t i = 0; i < words.size(); ++i) {
      const std::string input = in_quotes(last);
      std::string body = R"("add", "in1": )" + input + R"(, "in2": 0.25)";
      if (i % 16 == 3) body = R"("sin", "in": )" + input;
      if (i % 16 == 7)
        body = R"("ifgreater", "value1": )" + input + R"(, "value2": 0, "in1": 1, "in2": )" + input;
      if (in_effect && i % 16 == 11) body = R"("sum_lights", "in": )" + input;
      nodes.add(in_quotes(words[i]) + ": {\"type\": " + body + "}");
      last = words[i];
    }
    return nodes.text();
  };
  const std::string last = words.back();
  compiler.function(R"("function": "nodes", "inputs": {"the_input": {"type": "float"}}, "nodes": {)" +
                    chain("the_input", false) + R"(}, "outputs": {"out": )" + in_quotes(last) + "}");
  for (const bool lights : {false, true}) {
    const std::string moves = lights ? ""
                                     : R"(, "the_place": {"type": "combine3", "in1": "the_uv.x", "in2": ")" +
                                           last + R"(", "in3": 0})";
    compiler.effect(R"("effect": "nodes", "nodes": {"the_uv": {"type": "texcoord"}, "the_color": )" +
                    grey_of(last) + moves + ", " + chain("the_uv.x", lights) +
                    R"(}, "passes": [{"name": "base", "color": "the_color")" +
                    (lights ? "" : R"(, "position": "the_place")") + "}]");
  }
  return compiler.made();
}

Made effect_with_parameters(Chunk words) {
  Compiler compiler;
  Parameters parameters(words);
  parameters.nodes.add(R"("the_color": )" + grey_of(parameters.sum));
  parameters.nodes.add(R"("the_place": {"type": "combine3", "in1": ")" + parameters.sum +
                       R"(", "in2": 0, "in3": 0})");
  parameters.nodes.add(R"("the_other": {"type": "constant", "value": [1, 2, 3], "to": "color3"})");
  List passes;
  for (const std::string& word : words) {
    const bool first = &word == words.data();
    passes.add(
        R"({"name": )" + in_quotes(word) +
        (first ? R"(, "position": "the_place", "color": "the_color"})" : R"(, "color": "the_other"})"));
  }
  compiler.effect("\"effect\": " + in_quotes(words[0]) + R"(, "parameters": {)" + parameters.declared.text() +
                  R"(}, "nodes": {)" + parameters.nodes.text() + R"(}, "passes": [)" + passes.text() + "]");
  return compiler.made();
}

Made effect_with_images(Chunk words) {
  Compiler compiler;
  for (const bool by_parameter : {false, true}) {
    List parameters, nodes;
    std::vector<std::string> links;
    for (const std::string& word : words) {
      const std::string node = by_parameter ? "the_image_" + word : word;
      if (by_parameter && node.size() > 128) continue;
      if (by_parameter)
        parameters.add(in_quotes(word) + R"(: {"type": "filename", "value": ")" + word + ".png\"}");
      nodes.add(in_quotes(node) + R"(: {"type": "image", "file": )" +
                (by_parameter ? R"({"link": )" + in_quotes(word) + "}" : '"' + word + ".png\"") + "}");
      links.push_back(node);
    }
    const std::string sum = summed(nodes, links);
    compiler.effect(R"("effect": "images", "parameters": {)" + parameters.text() + R"(}, "nodes": {)" +
                    nodes.text() + R"(}, "passes": [{"name": "base", "color": )" + in_quotes(sum) + "}]");
  }
  return compiler.made();
}

Made post_with_parameters(Chunk words) {
  Compiler compiler;
  Parameters parameters(words);
  parameters.nodes.add(R"("the_color": )" + grey_of(parameters.sum));
  compiler.post("\"post\": " + in_quotes(words[0]) + R"(, "parameters": {)" + parameters.declared.text() +
                R"(}, "nodes": {)" + parameters.nodes.text() + R"(}, "outputs": {"color": "the_color"})");
  List nodes;
  nodes.add(R"("the_tap": {"type": "tapindex"})");
  nodes.add(R"("the_pixel": {"type": "scenecolor", "offsetx": "the_tap"})");
  std::vector<std::string> links;
  for (const std::string& word : words) {
    nodes.add(in_quotes(word) + R"(: {"type": "sum_taps", "in": "the_pixel", "last": 2})");
    links.push_back(word);
  }
  const std::string sum = summed(nodes, links);
  compiler.post(R"("post": "sums", "nodes": {)" + nodes.text() + R"(}, "outputs": {"color": )" +
                in_quotes(sum) + "}");
  return compiler.made();
}

Made post_with_images(Chunk words) {
  Compiler compiler;
  List images, nodes;
  std::vector<std::string> links;
  for (const std::string& word : words) {
    if (word == "color") continue;  // the one that the post goes over
    images.add(in_quotes(word));
    const std::string node = "the_read_" + std::to_string(links.size());
    // One is filtered, one read beside the pixel: the others have the same names and fewer lines.
    const char* how[] = {R"(, "filter": "linear"})", R"(, "offsetx": 1})", "}"};
    nodes.add(in_quotes(node) + R"(: {"type": "scenecolor", "image": )" + in_quotes(word) +
              how[std::min<size_t>(links.size(), 2)]);
    links.push_back(node);
  }
  const std::string sum = summed(nodes, links);
  compiler.post(R"("post": "images", "images": [)" + images.text() + R"(], "nodes": {)" + nodes.text() +
                R"(}, "outputs": {"color": )" + in_quotes(sum) + "}");
  return compiler.made();
}

std::vector<std::string> sample_texts() {
  std::vector<std::string> texts;
  support::Diagnostics diagnostics;
  check::Library library(ISOSHADE_ROOT "/graphs/library");
  driver::CompileOptions options;
  options.library = &library;
  const auto add = [&](const driver::Program& program) {
    texts.push_back(driver::glsl(program, driver::Division::exact));
    if (program.stage != driver::Stage::depth) texts.push_back(driver::cpp(program));
    if (program.stage == driver::Stage::eval)
      texts.push_back(driver::glsl_with_vertex_eval(program, driver::Division::native));
  };
  const auto read = [&](const char* path) {
    return graph::read_source(std::string(ISOSHADE_ROOT "/graphs/") + path, diagnostics);
  };
  add(driver::depth_program());
  std::vector<const char*> effects = {"materials/moved_vertices.json"}, posts = {"effects/height_fog.json"};
  if (is_full())
    effects.insert(effects.end(),
                   {"materials/gltf_pbr.json", "materials/derivatives.json", "effects/terrain.json",
                    "effects/dissolve.json", "effects/refraction.json"});
  for (const char* path : effects)
    if (const auto effect = driver::compile_effect(read(path), options, diagnostics))
      for (const driver::EffectPass& pass : effect->passes) {
        add(pass.vertex);
        add(pass.pixel);
        if (pass.cutout) add(*pass.cutout);
        if (pass.blend) add(*pass.blend);
      }
  for (const char* path : posts)
    if (const auto post = driver::compile_post(read(path), options, diagnostics)) add(post->program);
  if (const auto function = driver::compile_function(read("library/brdf/ggx_d.json"), options, diagnostics))
    add(*function);
  return texts;
}

}  // namespace isoshade::names
