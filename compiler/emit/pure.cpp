// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/pure.h"

#include <algorithm>
#include <array>

#include "compiler/ir/call_graph.h"
#include "compiler/support/assert.h"

namespace isoshade::emit {
namespace {

using interface::HostCall;
using interface::HostRow;
namespace place = interface::place;

/// One for each struct of points.
constexpr std::array kinds_of_points{PureKind::shade, PureKind::move_vertex, PureKind::post_process};

/// The local that holds a function's point.
std::string_view point_name(PureKind kind) {
  switch (kind) {
    case PureKind::shade:
    case PureKind::coverage:
    case PureKind::function: return "surface";
    case PureKind::move_vertex: return "vertex";
    case PureKind::post_process: return "screen";
  }
  return "";
}

/// What stands behind a field of a point.
std::string doc_of(const interface::Binding& binding) {
  namespace source = interface::source;
  const auto axis = [](interface::Axis a, const char* of_x, const char* of_y) {
    return std::string(a == interface::Axis::x ? of_x : of_y);
  };
  return std::visit(interface::Cases{
                        [](const source::Attribute& s) {
                          std::string doc(row(s.value.attribute).doc);
                          if (!row(s.value.attribute).has_spaces) return doc;
                          constexpr std::string_view spaces[] = {"world", "object", "view"};
                          return "In " + std::string(spaces[static_cast<size_t>(s.value.space)]) +
                                 " space. " + doc;
                        },
                        [](const source::ScreenValue& s) { return std::string(row(s.value).doc); },
                        [&](const source::PixelOfImage& s) {
                          return "The " + axis(s.axis, "column", "row") +
                                 " of the image's pixel under the centre of the pixel.";
                        },
                        [](const source::OffsetInPixel&) {
                          return std::string("Where in that pixel the centre lies, 0 to 1 each.");
                        },
                        [](const auto&) { return std::string(); },
                    },
                    binding.source);
}

/// Calls `add` for each parameter that is a field of the struct of points of a kind.
template <class Add>
void for_each_point_parameter(const PureShader& shader, PureKind kind, Add add) {
  for (const PureFunction& function : shader.functions) {
    if (point_record(function.kind) != point_record(kind)) continue;
    const std::vector<ir::Parameter>& parameters = shader.module.functions[function.entry].parameters;
    for (size_t i = 0; i < parameters.size(); ++i) {
      const interface::Binding* binding = i < function.bindings.size() ? &function.bindings[i] : nullptr;
      if (binding == nullptr ||
          std::holds_alternative<place::Point>(place_of(*binding, kind == PureKind::function)))
        add(parameters[i], binding);
    }
  }
}

/// The field of a parameter. An image may have the name of a matrix's column, but not its type.
const std::string& field_name(const std::vector<PureField>& fields, const ir::Parameter& parameter) {
  const auto found = std::ranges::find_if(fields, [&](const PureField& field) {
    return field.parameter.name == parameter.name && field.parameter.type == parameter.type;
  });
  support::assert_that(found != fields.end(), parameter.name);
  return found->name;
}

/// The fields of a record that the host returns.
std::vector<std::string> host_fields(std::string_view record) {
  if (record == "Light") return {"direction", "color"};
  support::assert_that(record == "ImageSize", record);
  return {"width", "height", "smaller"};
}

class PurePrinter {
 public:
  PurePrinter(const PureShader& shader, const PureLanguage& pure)
      : shader_(shader), pure_(pure), language_(pure.language()) {
    for (const PureKind kind : kinds_of_points) points_.push_back(point_fields(shader, kind));
  }

  std::string print() {
    std::vector<FunctionText> texts(shader_.module.functions.size());
    std::vector<uint32_t> entries;
    for (const PureFunction& function : shader_.functions) {
      entries.push_back(function.entry);
      write_entry(function, texts[function.entry]);
    }
    for (uint32_t i = 0; i < texts.size(); ++i)
      if (const auto found = shader_.host.find(shader_.module.functions[i].name); found != shader_.host.end())
        write_host(found->second, texts[i]);
    LinkedNames names{prefix(), shader_.tier.empty() ? "" : "_" + shader_.tier, records()};
    const LinkedText text = print_linked(shader_.module, entries, language_, names, texts);
    bool zero = std::ranges::any_of(entries, [&](uint32_t e) { return uses_hidden_zero(shader_.module, e); });
    for (const FunctionText& function : texts)
      for (const ParameterText& parameter : function.parameters)
        zero |= parameter.text.find(hidden_zero) != std::string::npos;
    std::vector<std::string> signatures;
    for (const PureFunction& function : shader_.functions)
      signatures.push_back(signature_of(function, texts[function.entry]));
    const std::string body = pure_.shared(shader_, text.shared) + structs() + text.own;
    const uint32_t hash = hash_of(body);
    return pure_.head(shader_, signatures, host_calls(shader_, shader_.functions), zero, hash) + body +
           pure_.tail(shader_, hash);
  }

 private:
  std::string prefix() const { return pure_.has_prefix() ? name_prefix(shader_) : ""; }
  std::string record(std::string_view name) const { return prefix() + std::string(name); }

  std::vector<std::string> records() const {
    std::vector<std::string> names{record(parameters_record), record(results_record)};
    for (const PureKind kind : kinds_of_points)
      if (kind != PureKind::function) names.push_back(record(point_record(kind)));  // that of shade
    return names;
  }

  const std::vector<PureField>& point(PureKind kind) const {
    const auto found = std::ranges::find(kinds_of_points, point_record(kind), point_record);
    return points_[static_cast<size_t>(found - kinds_of_points.begin())];
  }

  std::string structs() const {
    std::string out;
    const auto add = [&](std::string_view name, const std::vector<PureField>& fields, bool uniform) {
      if (fields.empty()) return;
      std::vector<RecordField> printed;
      for (const PureField& field : fields)
        printed.push_back({field.parameter.type, field.name, comment_text(comment_of(field.parameter))});
      language_.record(out, record(name), printed, uniform);
      out += "\n";
    };
    for (const PureKind kind : kinds_of_points) add(point_record(kind), point(kind), false);
    add(parameters_record, shader_.parameters, true);
    return out;
  }

  std::string call(HostCall call, int argument) const {
    const std::string arguments(language_.outside());
    const std::string number = argument < 0 ? "" : std::to_string(argument);
    return language_.host_function(interface::row(call).name) + "(" + arguments +
           (arguments.empty() || number.empty() ? "" : ", ") + number + ")";
  }

  ParameterText text_of(const PureFunction& function, const interface::Binding& binding) const {
    const ir::Parameter& parameter = binding.parameter;
    return std::visit(interface::Cases{
                          [&](const place::Point&) {
                            return ParameterText{std::string(point_name(function.kind)) + "." +
                                                 field_name(point(function.kind), parameter)};
                          },
                          [&](const place::Parameter&) {
                            return ParameterText{"parameters." + field_name(shader_.parameters, parameter)};
                          },
                          [&](const place::Argument&) { return ParameterText{}; },
                          [&](const place::Host& host) {
                            return ParameterText{call(host.call, host.argument), true};
                          },
                          [&](const place::Known& known) {
                            return ParameterText{language_.hidden_int(known.value), true};
                          },
                      },
                      place_of(binding, function.kind == PureKind::function));
  }

  void write_entry(const PureFunction& function, FunctionText& text) const {
    text.name = function_name(shader_, function, pure_.has_prefix());
    for (const HostCall call : host_calls(shader_, std::span(&function, 1)))
      text.asks.push_back(interface::row(call).name);
    if (function.kind == PureKind::function) {
      const std::vector<PureField> results = result_fields(shader_, function);
      if (results.size() > 1) text.result_type = record(results_record);
      for (const PureField& result : results)
        if (results.size() > 1) text.result_fields.push_back(result.name);
      if (takes_only_arguments(function)) return;
    }
    const std::vector<ir::Parameter>& parameters = shader_.module.functions[function.entry].parameters;
    for (size_t i = 0; i < parameters.size(); ++i) {
      const bool is_derivative = i >= function.bindings.size();
      text.parameters.push_back(is_derivative ? ParameterText{std::string(point_name(function.kind)) + "." +
                                                              field_name(point(function.kind), parameters[i])}
                                              : text_of(function, function.bindings[i]));
    }
    const auto declare = [&](std::string_view name, std::string_view type, bool uniform) {
      text.local_names.emplace_back(name);
      text.signature += text.signature.empty() ? "" : ", ";
      const bool is_read = std::ranges::any_of(text.parameters, [&](const ParameterText& parameter) {
        return parameter.text.starts_with(std::string(name) + ".");
      });
      language_.record_parameter(text.signature, record(type), name, uniform, is_read);
    };
    if (!point(function.kind).empty()) declare(point_name(function.kind), point_record(function.kind), false);
    if (!shader_.parameters.empty()) declare("parameters", parameters_record, true);
    if (function.kind == PureKind::function) declare_arguments(function, text);
    text.has_signature = true;
    text.is_given_host = function.kind != PureKind::function || !text.asks.empty();
  }

  static bool takes_only_arguments(const PureFunction& function, const ir::Function& entry) {
    return entry.parameters.size() == function.bindings.size() &&
           std::ranges::all_of(function.bindings, [](const interface::Binding& binding) {
             return std::holds_alternative<place::Argument>(place_of(binding, true));
           });
  }
  bool takes_only_arguments(const PureFunction& function) const {
    return takes_only_arguments(function, shader_.module.functions[function.entry]);
  }

  /// The inputs and images of a function document that is given a point or asks its host, too.
  void declare_arguments(const PureFunction& function, FunctionText& text) const {
    const ir::Function& entry = shader_.module.functions[function.entry];
    Names names(Scope::local);
    for (const std::string& name : text.local_names) names.hold(name);
    for (size_t i = 0; i < function.bindings.size(); ++i) {
      if (!std::holds_alternative<place::Argument>(place_of(function.bindings[i], true))) continue;
      const ir::Parameter& parameter = entry.parameters[i];
      text.parameters[i].text = names.take(parameter.name);
      text.local_names.push_back(text.parameters[i].text);
      text.signature += text.signature.empty() ? "" : ", ";
      language_.parameter(text.signature, parameter.type, parameter.uniform, text.parameters[i].text,
                          reads(entry, entry.blocks[0].parameters[i]));
    }
  }

  static bool reads(const ir::Function& function, ir::ValueId value) {
    const auto has = [&](std::span<const ir::ValueId> values) {
      return std::ranges::find(values, value) != values.end();
    };
    return std::ranges::any_of(function.instructions,
                               [&](const ir::Instruction& made) { return has(function.operands_of(made)); }) ||
           std::ranges::any_of(function.blocks, [&](const ir::Block& block) { return has(block.yields); });
  }

  /// "vec4 cook_torrance_shade(cook_torrance_Surface surface, cook_torrance_Parameters parameters)"
  std::string signature_of(const PureFunction& function, const FunctionText& text) const {
    const ir::Function& made = shader_.module.functions[function.entry];
    std::string out;
    language_.declaration(out, made, text);
    if (text.has_signature) {
      if (out.back() != '(' && !text.signature.empty()) out += ", ";
      return out + text.signature + ")";
    }
    if (std::ranges::any_of(made.parameters, [](const ir::Parameter& p) { return !p.group.empty(); }))
      return out + "...)";
    for (size_t i = 0; i < made.parameters.size(); ++i) {
      if (out.back() != '(') out += ", ";
      language_.parameter(out, made.parameters[i].type, made.parameters[i].uniform, made.parameters[i].name,
                          true);
    }
    return out + ")";
  }

  void write_host(const interface::HostFunction& function, FunctionText& text) const {
    const std::optional<interface::Answer> answer = answer_of(function);
    if (!answer) return;
    const HostRow& asked = interface::row(answer->call);
    text.host = language_.host_function(asked.name);
    text.noun = asked.name;
    if (answer->image >= 0) text.leading = std::to_string(answer->image);
    if (!asked.returns_record()) return;
    text.result_type = language_.host_record(asked.result);
    text.result_fields = host_fields(asked.result);
  }

  const PureShader& shader_;
  const PureLanguage& pure_;
  const Language& language_;
  std::vector<std::vector<PureField>> points_;  ///< by kinds_of_points
};

}  // namespace

std::string name_prefix(const PureShader& shader) {
  return shader.prefix.ends_with('_') ? shader.prefix : shader.prefix + "_";
}

std::string_view point_record(PureKind kind) {
  switch (kind) {
    case PureKind::shade:
    case PureKind::coverage:
    case PureKind::function: return "Surface";
    case PureKind::move_vertex: return "Vertex";
    case PureKind::post_process: return "Screen";
  }
  return "";
}

namespace {

/// Of the field "a_ddx", or "a_ddx_ddy".
std::string doc_of_derivative(std::string_view name) {
  const size_t x = name.rfind("_ddx"), y = name.rfind("_ddy");
  const bool is_x = y == std::string_view::npos || (x != std::string_view::npos && x > y);
  const std::string_view of = name.substr(0, is_x ? x : y);
  const bool is_second = of.ends_with("_ddx") || of.ends_with("_ddy");
  return "What " + (is_second ? "`" + std::string(of) + "`" : "it") + " changes by to the next pixel " +
         (is_x ? "to the right." : "below.");
}

}  // namespace

std::vector<PureField> point_fields(const PureShader& shader, PureKind kind) {
  struct Found {
    ir::Parameter parameter;
    size_t rank;
  };
  std::vector<Found> found;
  for_each_point_parameter(
      shader, kind, [&](const ir::Parameter& parameter, const interface::Binding* binding) {
        const auto same = [&](const Found& other) { return other.parameter.name == parameter.name; };
        if (std::ranges::any_of(found, same)) return;
        // Attributes in the order of their table, all else as the functions have it, derivatives last.
        size_t rank =
            binding == nullptr ? 2 * interface::surface_value_count : interface::surface_value_count;
        if (binding != nullptr)
          if (const auto* attribute = std::get_if<interface::source::Attribute>(&binding->source))
            rank = attribute->value.index();
        found.push_back({parameter, rank});
        found.back().parameter.doc = binding != nullptr ? doc_of(*binding) : doc_of_derivative(parameter.name);
      });
  std::ranges::stable_sort(found, {}, &Found::rank);
  Names names(Scope::field);
  std::vector<PureField> fields;
  for (Found& field : found) fields.push_back({names.take(field.parameter.name), std::move(field.parameter)});
  return fields;
}

std::vector<PureField> result_fields(const PureShader& shader, const PureFunction& function) {
  Names names(Scope::field);
  std::vector<PureField> fields;
  for (const ir::Result& result : shader.module.functions[function.entry].results) {
    PureField& field = fields.emplace_back();
    field.name = names.take(result.name);
    field.parameter.name = result.name;
    field.parameter.type = result.type;
  }
  return fields;
}

std::string function_name(const PureShader& shader, const PureFunction& function, bool with_prefix) {
  if (function.kind == PureKind::function) return shader.prefix;
  const std::string& name = shader.module.functions[function.entry].name;
  return with_prefix ? name_prefix(shader) + name : name;
}

std::vector<HostCall> host_calls(const PureShader& shader, std::span<const PureFunction> functions) {
  std::vector<bool> asked(interface::host_call_count);
  const auto ask = [&](HostCall call) { asked[static_cast<size_t>(call)] = true; };
  std::vector<uint32_t> entries;
  for (const PureFunction& function : functions) {
    entries.push_back(function.entry);
    for (const interface::Binding& binding : function.bindings) {
      const interface::Place at = place_of(binding, function.kind == PureKind::function);
      if (const auto* host = std::get_if<place::Host>(&at)) ask(host->call);
    }
  }
  const auto reached = ir::callees_first(shader.module, entries);
  support::assert_that(reached.has_value(), "a function of a pure shader reaches itself");
  for (const uint32_t index : *reached)
    if (const auto found = shader.host.find(shader.module.functions[index].name); found != shader.host.end())
      if (const auto answer = answer_of(found->second)) ask(answer->call);
  std::vector<HostCall> calls;
  for (size_t i = 0; i < asked.size(); ++i)
    if (asked[i]) calls.push_back(static_cast<HostCall>(i));
  return calls;
}

std::string print_pure(const PureShader& shader, const PureLanguage& language) {
  return PurePrinter(shader, language).print();
}

}  // namespace isoshade::emit
