// SPDX-License-Identifier: Apache-2.0
#include "tests/equivalence/pure_subject.h"

#include <algorithm>
#include <array>
#include <gtest/gtest.h>
#include <random>

#include "compiler/lower/kernel.h"
#include "compiler/passes/passes.h"
#include "tests/equivalence/pure_host.h"

namespace isoshade::equivalence {

namespace place = interface::place;
using emit::PureFunction;
using emit::PureKind;

int words_of(const std::vector<emit::PureField>& fields) {
  int words = 0;
  for (const emit::PureField& field : fields) words += field.parameter.type.width;
  return words;
}

/// The runtime's way: the document's function with the host's answers, behind the kernel for tables.
driver::Program runtime_program(const driver::Shader& shader, size_t entry, const Subject& subject) {
  lower::LoweredShader lowered = lower::lower_shader(*shader.typed);
  lowered.module.buffers = lower::frame_module().buffers;
  std::map<std::string, interface::HostFunction> host;
  for (const interface::HostFunction& function : lowered.entries[entry].interface.host)
    host[lowered.module.functions[function.function].name] = function;
  define_host(lowered.module, host);
  passes::derivatives(lowered.module);
  const interface::Interface& interface = lowered.entries[entry].interface;
  const std::vector<ir::Parameter> wanted = lowered.module.functions[interface.entry].parameters;
  std::vector<ir::Parameter> columns;
  std::vector<std::string> names;
  for (const auto* fields : {&subject.points, &subject.parameters})
    for (const emit::PureField& field : *fields) {
      names.push_back((fields == &subject.points ? "point." : "parameter.") + field.parameter.name);
      columns.push_back({"c" + std::to_string(columns.size()), field.parameter.type, "", false,
                         field.parameter.least, field.parameter.most});
    }
  lower::Kernel k(lowered.module, "probe", columns, lowered.module.functions[interface.entry].results);
  std::vector<ir::ValueId> arguments;
  for (size_t i = 0; i < wanted.size(); ++i) {
    const auto column = [&](const std::string& space) {
      for (size_t c = 0; c < names.size(); ++c)
        if (names[c] == space + wanted[i].name && columns[c].type == wanted[i].type) return k.b.parameter(c);
      support::bug("no column for " + wanted[i].name);
    };
    if (i >= interface.bindings.size()) {
      arguments.push_back(column("point."));
      continue;
    }
    arguments.push_back(std::visit(interface::Cases{
                                       [&](const place::Point&) { return column("point."); },
                                       [&](const place::Parameter&) { return column("parameter."); },
                                       [&](const place::Argument&) { return column("parameter."); },
                                       [&](const place::Host& asked) { return answer(k, asked); },
                                       [&](const place::Known& known) { return k.b.constant(known.value); },
                                   },
                                   place_of(interface.bindings[i], false)));
  }
  // A count of turns is uniform, as it is where a kernel passes it.
  k.b.finish(k.b.call(interface.entry, arguments));
  return driver::finish_eval(std::move(lowered.module), k.index, subject.name);
}

std::vector<int32_t> table_of(const Subject& subject, size_t rows) {
  std::mt19937 random(7);
  const auto uniform = [&](float low, float high) {
    return low + (high - low) * static_cast<float>(random() >> 8) * 0x1p-24f;
  };
  const auto word = [&](const ir::Parameter& parameter) {
    const float low = std::max(parameter.least.value_or(-1.5f), -4.0f);
    const float high = std::min(parameter.most.value_or(std::max(low, 1.5f)), std::max(low, 4.0f));
    if (parameter.type == ir::bool_type) return static_cast<int32_t>(random() & 1);
    if (parameter.type == ir::int_type && parameter.group == "images")
      return static_cast<int32_t>(random() % 4) - 1;
    if (parameter.type == ir::int_type && parameter.group == "screen")
      return static_cast<int32_t>(random() % 4);
    if (parameter.type == ir::int_type) return static_cast<int32_t>(std::floor(uniform(low, high + 0.99f)));
    return std::bit_cast<int32_t>(random() % 8 == 0 ? (random() % 2 == 0 ? low : high) : uniform(low, high));
  };
  std::vector<int32_t> table(rows * static_cast<size_t>(subject.stride));
  for (size_t row = 0; row < rows; ++row) {
    int32_t* out = table.data() + row * static_cast<size_t>(subject.stride);
    for (const emit::PureField& field : subject.points)
      for (int i = 0; i < field.parameter.type.width; ++i) *out++ = word(field.parameter);
    const int parameter_words = words_of(subject.parameters);
    if (row % rows_of_a_batch != 0) std::copy_n(out - subject.stride, parameter_words, out);
    for (const emit::PureField& field : subject.parameters)
      for (int i = 0; i < field.parameter.type.width && row % rows_of_a_batch == 0; ++i)
        *out++ = word(field.parameter);
  }
  return table;
}

Subjects subjects_of(const std::vector<std::filesystem::path>& paths, driver::Division division) {
  Subjects made;
  support::Diagnostics diagnostics;
  check::Library library(ISOSHADE_GRAPHS "/library");
  driver::CompileOptions options;
  options.library = &library;
  for (const std::filesystem::path& path : paths) {
    const support::Source source = graph::read_source(path.string(), diagnostics);
    const auto kind = driver::kind_of(source, diagnostics);
    if (kind != graph::DocumentKind::effect && kind != graph::DocumentKind::post) continue;
    // Documents of several folders may have the same name.
    const std::string prefix = path.parent_path().filename().string() + "_" + path.stem().string();
    auto shader = driver::compile_shader(source, options, {prefix, division}, diagnostics);
    EXPECT_TRUE(shader) << diagnostics.text();
    if (!shader) continue;
    made.shaders.push_back(std::make_unique<driver::Shader>(*std::move(shader)));
    const driver::Shader& kept = *made.shaders.back();
    for (size_t i = 0; i < kept.pure.functions.size(); ++i) {
      const PureFunction& function = kept.pure.functions[i];
      Subject subject;
      subject.function = function_name(kept.pure, function, false);
      subject.name = kept.pure.prefix + "_" + subject.function;
      subject.point = emit::point_record(function.kind);
      subject.points = point_fields(kept.pure, function.kind);
      subject.parameters = kept.pure.parameters;
      subject.shader = &kept;
      subject.stride = words_of(subject.points) + words_of(subject.parameters);
      subject.result = kept.pure.module.functions[function.entry].results.at(0).type;
      subject.words = subject.result.width;
      if (subject.stride == 0) continue;
      subject.runtime = runtime_program(kept, i, subject);
      made.all.push_back(std::move(subject));
    }
  }
  return made;
}

}  // namespace isoshade::equivalence
