// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <span>

#include "compiler/check/node_inference.h"

namespace isoshade::check {
using graph::Link;
using graph::Literal;
using nodes::PortType;
using nodes::Variable;
using support::Id;
using support::quote;

std::string conversion_hint(const Link& link, Type to) {
  if (to == Type::filename) return "link a parameter of type filename, or write a path";
  if (nodes::matrix_types.has(to)) return "build a matrix from its columns with a creatematrix node";
  if (link.node != Link::unresolved) return "convert it: " + name_of(to) + "(...)";
  std::string text = link.name;
  for (const std::string& selector : link.selectors) text += "." + selector;
  return R"(convert it with a node {"type": "convert", "in": ")" + text + R"(", "to": ")" + name_of(to) +
         R"("})";
}

std::optional<Type> joined(Type a, Type b) {
  if (converts(a, b)) return b;
  if (converts(b, a)) return a;
  return std::nullopt;
}

Type tuple_of(size_t numbers, nodes::TypeSet accepts) {
  switch (numbers) {
    case 2: return Type::vector2;
    case 3: return !accepts.has(Type::vector3) && accepts.has(Type::color3) ? Type::color3 : Type::vector3;
    case 9: return Type::matrix33;
    case 16: return Type::matrix44;
    default: return !accepts.has(Type::vector4) && accepts.has(Type::color4) ? Type::color4 : Type::vector4;
  }
}

bool takes_as_color(const Work& work, Operand& operand, const Link& link, Type needed) {
  if (!nodes::color_types.has(needed) || graph::float_count(operand.type) != graph::float_count(needed) ||
      !work.is_untyped(operand, link))
    return false;
  operand.type = needed;
  return true;
}

bool NodeInference::takes(size_t i, Type needed) {
  return converts(operand(i).type, needed) || takes_as_color(work_, operand(i), *given(i).link, needed);
}

/// Whether the output's vector type comes only from literal arrays of numbers or from untyped operands.
bool NodeInference::makes_untyped() {
  const Variable variable = node_.row->outputs[0].type.variable;
  if (variable == Variable::none || !nodes::vector_types.has(type_of(node_.row->outputs[0].type))) return false;
  bool has_array = false;
  for (size_t i = 0; i < node_.operand_count; ++i) {
    if (port(i).type.variable != variable || given(i).port == nullptr) continue;
    if (!is_value(i)) return false;
    const Literal* value = literal(i);
    const bool array = value != nullptr ? value->kind == Literal::Kind::numbers : is_untyped(i);
    if (value == nullptr && !array && nodes::vector_types.has(operand(i).type)) return false;
    has_array |= array;
  }
  return has_array;
}

void NodeInference::infer_row() {
  const size_t count = node_.operand_count;
  for (size_t i = 0; i < count; ++i) {
    if (is_value(i)) continue;
    const PortType::Kind kind = port(i).type.kind;
    const bool is_number = kind == PortType::Kind::component || kind == PortType::Kind::integer;
    is_number ? read_integer(i) : read_text(i);
  }
  if (!broken()) settle_by_links();
  if (!broken()) settle_by_literals();
  if (!broken()) check_settled();
  for (size_t i = 0; i < count && !broken(); ++i)
    if (is_value(i)) place_value(i);
  if (broken()) return;
  node_.first_type = static_cast<uint32_t>(work_.typed.types.size());
  node_.output_count = static_cast<uint32_t>(node_.row->outputs.size());
  for (const nodes::Output& output : node_.row->outputs) work_.typed.types.push_back(type_of(output.type));
  work_.untyped[index_] = makes_untyped();
  if (node_.row->condition != nullptr) check_condition();
}

/// Checks a link in place of a choice: to an integer input whose values are called as the first of the choices, so that
/// its number is that of the choice.
void NodeInference::check_chosen(size_t i) {
  const graph::Graph& graph = work_.graph();
  const std::vector<std::string_view>& choices = port(i).choices;
  Operand& to = operand(i);
  if (to.from == Operand::From::input) {
    const std::vector<std::string>& names = graph.inputs[to.index].names;
    const bool fits = !names.empty() && names.size() <= choices.size();
    if (fits && std::ranges::equal(names, std::span(choices).first(names.size()))) {
      to.needed = Type::integer;
      return;
    }
  }
  const std::string word = graph.kind == graph::DocumentKind::function ? "an input" : "a parameter";
  std::string list;
  for (const std::string_view choice : choices) list += (list.empty() ? "" : ", ") + quote(choice);
  report(Id::type_mismatch, i, of_node(i) + " takes a link only to " + word + " with an \"enum\" of its choices")
      .suggest("declare " + word + " with \"type\": \"integer\", \"enum\": [" + list + "]; the last may be left out");
}

void NodeInference::read_text(size_t i) {
  if (given(i).link != nullptr) return check_chosen(i);
  const bool is_type = port(i).type.kind == PortType::Kind::type_name;
  std::string_view text;
  if (given(i).port == nullptr) {
    text = std::get<std::string_view>(port(i).value);
    if (text.empty()) return;
  } else if (literal(i)->kind == Literal::Kind::string) {
    text = literal(i)->string;
  } else {
    report(Id::wrong_type, i, of_node(i) + " must be a string, not " + described(*literal(i)));
    return;
  }
  if (is_type) return read_type_name(i, text);
  operand(i).from = Operand::From::setting;
  if (port(i).type.kind == PortType::Kind::image) return read_image(i, text);
  const std::vector<std::string_view>& choices = port(i).choices;
  for (uint32_t choice = 0; choice < choices.size(); ++choice) {
    operand(i).index = choice;
    if (choices[choice] == text) return;
  }
  support::Diagnostic& wrong = report(Id::unknown_choice, i, of_node(i) + " cannot be " + quote(text));
  suggest_nearest(work_.diagnostics, wrong, text, choices);
  wrong.note("it can be " + listed(choices, "or"));
}

/// The index is 0 for the image that the post processes, else 1 + the index in Graph::images.
void NodeInference::read_image(size_t i, std::string_view name) {
  if (given(i).port == nullptr) return;
  const std::vector<graph::InputImage>& images = work_.graph().images;
  std::vector<std::string_view> names;
  for (uint32_t image = 0; image < images.size(); ++image) {
    operand(i).index = image + 1;
    if (images[image].name == name) return;
    names.push_back(images[image].name);
  }
  support::Diagnostic& wrong = report(Id::unknown_image, i, "the document has no image " + quote(name));
  suggest_nearest(work_.diagnostics, wrong, name, names);
  wrong.note(names.empty() ? "the key \"images\" of the document declares the images that a scene passes to it"
                           : "its images are " + listed(names));
}

void NodeInference::read_type_name(size_t i, std::string_view text) {
  const std::optional<Type> type = graph::find_type(text);
  if (type && port(i).type.accepts.has(*type)) {
    settled(i) = {*type, i};
    operand(i).from = Operand::From::setting;
    operand(i).index = static_cast<uint32_t>(*type);
    return;
  }
  support::Diagnostic& wrong =
      report(type ? Id::type_mismatch : Id::unknown_type, i,
             type ? of_node(i) + " cannot be " + name_of(*type) : "there is no type " + quote(text));
  if (!type) suggest_nearest(work_.diagnostics, wrong, text, graph::all_type_names());
  wrong.note("it can be " + described(port(i).type.accepts));
}

void NodeInference::read_integer(size_t i) {
  int64_t index = 0;
  if (given(i).port != nullptr) {
    const Literal& written = *literal(i);
    if (!graph::fits(Type::integer, written)) {
      const bool is_number = written.kind == Literal::Kind::number;
      report(Id::wrong_type, i,
             of_node(i) + " must be a literal integer of 32 bits, not " +
                 (is_number ? "a number with a fraction or beyond 32 bits" : described(written)));
      return;
    }
    index = written.integer;
  }
  operand(i).from = Operand::From::setting;
  operand(i).index = static_cast<uint32_t>(index);
}

void NodeInference::join(size_t i, Type type) {
  Settled& at = settled(i);
  if (!at.type) {
    at = {type, i};
    return;
  }
  const bool named = !is_value(at.port);
  const std::optional<Type> both = named && !converts(type, *at.type) ? std::nullopt : joined(*at.type, type);
  if (!both) {
    const std::string other =
        named ? "it must be " + name_of(*at.type) : of_other(at.port) + " is " + name_of(*at.type);
    support::Diagnostic& wrong =
        report(Id::type_mismatch, i, of_node(i) + " is " + name_of(type) + ", but " + other);
    if (given(i).link != nullptr) wrong.suggest(conversion_hint(*given(i).link, *at.type));
  } else if (*both != *at.type) {
    at = {*both, i};
  }
}

void NodeInference::settle_by_links() {
  // Untyped operands adopt the type of the others, so they come last.
  for (const bool untyped : {false, true}) {
    for (size_t i = 0; i < node_.operand_count && !broken(); ++i) {
      if (!is_value(i) || given(i).link == nullptr || port(i).type.variable == Variable::none) continue;
      if (is_untyped(i) != untyped) continue;
      const std::optional<Type> type = settled(i).type;
      if (type && takes_as_color(work_, operand(i), *given(i).link, *type)) continue;
      // The port accepts only colours.
      for (const Type color : {Type::color3, Type::color4})
        if (port(i).type.accepts.has(color) && !port(i).type.accepts.has(operand(i).type))
          takes_as_color(work_, operand(i), *given(i).link, color);
      join(i, operand(i).type);
    }
  }
}

void NodeInference::settle_by_literals() {
  // Arrays and booleans determine a type; numbers adopt the type of the others.
  for (size_t i = 0; i < node_.operand_count && !broken(); ++i) {
    const Literal* value = literal(i);
    if (value == nullptr || !is_value(i) || port(i).type.variable == Variable::none) continue;
    const Settled& at = settled(i);
    if (at.type && fits(*value, *at.type)) continue;
    const size_t numbers = value->numbers.size();
    const bool tuple = (numbers >= 2 && numbers <= 4) || numbers == 9 || numbers == 16;
    if (value->kind == Literal::Kind::boolean) {
      join(i, Type::boolean);
    } else if (tuple && !(at.type && graph::float_count(*at.type) == static_cast<int>(numbers))) {
      join(i, tuple_of(numbers, port(i).type.accepts));
    } else if (value->kind == Literal::Kind::numbers) {
      report(Id::wrong_type, i,
             of_node(i) + " takes " + described(port(i).type.accepts) + ", not " + described(*value));
    }
  }
  for (size_t i = 0; i < node_.operand_count; ++i)
    if (is_value(i) && port(i).type.variable != Variable::none && !settled(i).type)
      settled(i) = {natural_type(i), i};
}

void NodeInference::check_settled() {
  for (size_t i = 0; i < node_.operand_count && !broken(); ++i) {
    if (port(i).type.variable == Variable::none) continue;
    Settled& at = settled(i);
    const nodes::TypeSet accepts = port(i).type.accepts;
    if (accepts.has(*at.type)) continue;
    if (*at.type == Type::integer && accepts.has(Type::floating)) {
      at.type = Type::floating;
      continue;
    }
    report(Id::type_mismatch, at.port,
           of_node(at.port) + " takes " + described(accepts) + ", not " + name_of(*at.type));
  }
}

/// Whether `name` is a parameter or an input of type filename.
bool is_file_parameter(const graph::Graph& graph, const std::string& name) {
  const auto found = graph.names.find(name);
  return found && found->is_input && graph.inputs[found->index].type == Type::filename;
}

void NodeInference::place_path(size_t i) {
  const std::string& path = literal(i)->string;
  const graph::Graph& graph = work_.graph();
  if (!is_file_parameter(graph, path))
    return place_file(work_.typed, {path, work_.span(given(i).port->place)}, operand(i));
  const bool in_function = graph.kind == graph::DocumentKind::function;
  report(Id::wrong_type, i,
         of_node(i) + " is a path, but " + quote(path) + (in_function ? " is an input" : " is a parameter"))
      .suggest("write {\"link\": \"" + path + "\"}, or \"./" + path + "\" for a file of that name");
}

void NodeInference::place_value(size_t i) {
  const Type needed = type_of(port(i).type);
  Operand& to = operand(i);
  if (given(i).link != nullptr) {
    to.needed = needed;
    if (takes(i, needed)) return;
    report(Id::type_mismatch, i, of_node(i) + " takes " + name_of(needed) + ", not " + name_of(to.type))
        .suggest(conversion_hint(*given(i).link, needed));
  } else if (const Literal* value = literal(i)) {
    if (fits(*value, needed) && needed == Type::filename) return place_path(i);
    if (fits(*value, needed)) return place(work_.typed, *value, needed, to);
    report(Id::wrong_type, i, of_node(i) + " must be " + name_of(needed) + ", not " + described(*value));
  } else {
    place(work_.typed, port(i).value, needed, to);
  }
}

void NodeInference::check_condition() {
  std::vector<Type> types;
  std::vector<uint32_t> settings;
  for (size_t i = 0; i < node_.operand_count; ++i) {
    types.push_back(operand(i).needed);
    settings.push_back(operand(i).from == Operand::From::setting ? operand(i).index : 0);
  }
  const Type out = work_.typed.types[node_.first_type];
  if (std::optional<nodes::Refusal> refusal = node_.row->condition(types, settings, out))
    report(refusal->id, refusal->port, std::move(refusal->message));
}

namespace {

/// Infers the type of an output of the document.
void infer_output(Work& work, size_t i) {
  Operand& output = work.typed.outputs[i];
  const Link& link = *work.roots[i];
  if (!select(work, link, output)) return;
  output.needed = output.type;
  if (work.graph().kind == graph::DocumentKind::function) {
    if (output.type == Type::filename)
      work.report(Id::type_mismatch, link.place, "an output cannot be filename")
          .suggest("read the image with an image node, and return the colour");
    return;
  }
  if (i >= work.typed.values().size()) {
    if (output.type == Type::vector3) return;
    work.report(Id::type_mismatch, link.place, "\"position\" must be vector3, not " + name_of(output.type));
    return;
  }
  for (const Type color : {Type::color3, Type::color4})
    if (takes_as_color(work, output, link, color)) output.needed = color;
  if (nodes::color_types.has(output.type)) return;
  output.needed = Type::color3;
  if (converts(output.type, Type::color3)) return;
  work.report(Id::type_mismatch, link.place, "\"color\" must be color3 or color4, not " + name_of(output.type))
      .suggest(conversion_hint(link, Type::color3));
}

/// Takes the type of a cutout, or of a cutoff, from what its link names; float for numbers.
bool infer_threshold(Work& work, const Link& link, bool may_be_boolean, Operand& operand) {
  if (!select(work, link, operand)) return false;
  operand.needed = operand.type;
  if (may_be_boolean && operand.type == Type::boolean) return true;
  operand.needed = Type::floating;
  if (operand.type == Type::floating || converts(operand.type, Type::floating)) return true;
  work.report(Id::type_mismatch, link.place,
              std::string(may_be_boolean ? "\"cutout\" must be boolean or float, not " : "\"cutoff\" must be float, not ") +
                  name_of(operand.type));
  return false;
}

/// `first`: the index of the cutout of a pass in the outputs; its cutoff follows.
void infer_cutout(Work& work, size_t first) {
  Operand &cutout = work.typed.outputs[first], &cutoff = work.typed.outputs[first + 1];
  const Link* const given = work.roots[first + 1];
  if (!infer_threshold(work, *work.roots[first], true, cutout)) return;
  if (cutout.type != Type::boolean) {
    graph::Literal usual;
    usual.number = graph::default_cutoff;
    given != nullptr ? void(infer_threshold(work, *given, false, cutoff)) : place(work.typed, usual, Type::floating, cutoff);
  } else if (given != nullptr) {
    work.report(Id::type_mismatch, given->place, "\"cutoff\" belongs to a float \"cutout\", and this one is a boolean")
        .note(work.span(work.roots[first]->place), "the cutout is here")
        .suggest("remove \"cutoff\"");
  }
}

}  // namespace

void infer(Work& work) {
  work.typed.types.reserve(work.typed.nodes.size());
  work.untyped.resize(work.typed.nodes.size());
  for (const uint32_t node : work.typed.order)
    if (!work.broken[node]) NodeInference(work, node).infer();
  const size_t cutouts = work.typed.outputs.size() - work.typed.cutouts().size();
  for (size_t i = 0; i < cutouts; ++i) infer_output(work, i);
  for (size_t i = cutouts; i < work.typed.outputs.size(); i += 2) infer_cutout(work, i);
}

}  // namespace isoshade::check
