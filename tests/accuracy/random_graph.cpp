// SPDX-License-Identifier: Apache-2.0
#include "tests/accuracy/random_graph.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "compiler/nodes/example.h"
#include "tests/accuracy/random_graph_tables.h"

namespace isoshade::accuracy {
namespace {

using graph::Type;
using nodes::Example;
using nodes::Port;
using nodes::PortType;
using nodes::Row;

enum class Turn : uint8_t { none, light, tap };

/// A value that nodes may read.
struct Source {
  std::string link;
  Type type;
  Turn turn = Turn::none;
  bool fresh = true;  ///< nothing reads it yet
};

bool is_tuple(Type type) { return (nodes::vector_types | nodes::color_types).has(type); }
std::string in_quotes(std::string_view text) { return "\"" + std::string(text) + "\""; }
std::string number(double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "%.9g", value);
  return buffer;
}

class Maker {
 public:
  Maker(uint64_t seed, const std::string& library)
      : random_(seed * 0x9e3779b97f4a7c15 + 1), library_(library) {
    constexpr graph::DocumentKind kinds[] = {graph::DocumentKind::function, graph::DocumentKind::function,
                                             graph::DocumentKind::effect, graph::DocumentKind::post};
    kind_ = kinds[seed % std::size(kinds)];
  }

  std::string run();

 private:
  uint32_t below(size_t count) { return static_cast<uint32_t>(random_() % count); }
  bool chance(double part) { return unit() < part; }
  double unit() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  template <class List>
  const auto& any(const List& list) {
    return list[below(std::size(list))];
  }
  Type any_type(nodes::TypeSet set) { return any(nodes::types_in(set)); }

  double value_in(Range range);
  std::string literal(Type type, const Range* range);
  void add_input();
  std::string add_node(const std::string& body, Type type, Turn turn);
  std::string add_constant(Type type, const Range* range);

  /// What a port of this type is given, as JSON: a link, or a literal where `literals` allows it.
  std::string argument(Type type, const Range* range, bool literals, Turn& turn);
  Source* readable(Type type);
  std::string linked(Source& source, Type type, const Range* range, Turn& turn);
  std::string tamed(const std::string& link, Type type, const Range& range, Turn turn);

  bool allowed(const Row& row) const;
  void add_row();
  void add_expression();
  void add_call();
  void add_sum();
  void add_outputs();

  std::mt19937_64 random_;
  const std::string& library_;
  graph::DocumentKind kind_;
  std::string inputs_, nodes_, rest_;
  std::vector<Source> sources_;
  int node_count_ = 0;
  int input_count_ = 0;
};

double Maker::value_in(Range range) {
  switch (below(5)) {
    case 0: return range.lo;
    case 1: return range.hi;
    case 2: {
      constexpr double special[] = {0, 1, -1, 0.5, 2, 0.25, 1e-3, 100, 0x1p-126, 3};
      return std::clamp(any(special), range.lo, range.hi);
    }
    default: break;
  }
  if (range.lo > 0 && chance(0.5))
    return std::clamp(range.lo * std::pow(range.hi / range.lo, unit()), range.lo, range.hi);
  return range.lo + (range.hi - range.lo) * unit();
}

std::string Maker::literal(Type type, const Range* range) {
  if (type == Type::boolean) return chance(0.5) ? "true" : "false";
  if (type == Type::integer) return std::to_string(static_cast<int>(below(12)) - 3);
  constexpr Range usual[] = {{0, 1}, {-4, 4}, {0.1, 10}, {0, 1000}, {-1e-30, 1e-30}};
  const Range from = range != nullptr ? *range : any(usual);
  const int count = graph::float_count(type);
  if (count == 1) return number(value_in(from));
  std::string text;
  for (int i = 0; i < count; ++i) text += (i == 0 ? "[" : ", ") + number(value_in(from));
  return text + "]";
}

void Maker::add_input() {
  constexpr Type types[] = {Type::floating, Type::floating, Type::floating, Type::vector2, Type::vector3,
                            Type::vector3,  Type::vector4,  Type::color3,   Type::color4,  Type::boolean,
                            Type::integer,  Type::matrix33, Type::matrix44};
  const bool is_function = kind_ == graph::DocumentKind::function;
  Type type = any(types);
  if (!is_function && nodes::matrix_types.has(type)) type = Type::color4;  // no parameter is a matrix
  const std::string name = "i" + std::to_string(input_count_++);
  std::string text = in_quotes(name) + ": {\"type\": " + in_quotes(graph::type_name(type));
  const bool unit = is_function && nodes::vector_types.has(type) && chance(0.25);
  Range range = any(ranges);
  bool bounded = type != Type::boolean && !unit && chance(0.9);
  if (type == Type::integer) range = {static_cast<double>(below(5)) - 2, static_cast<double>(below(20)) + 3};
  if (unit) text += ", \"unit\": true";
  if (bounded) text += ", \"min\": " + number(range.lo) + ", \"max\": " + number(range.hi);
  if (!is_function) {
    const Range given = bounded ? range : Range{0, 1};
    text += ", \"value\": " + (type == Type::integer ? number(given.lo) : literal(type, &given));
  }
  inputs_ += (inputs_.empty() ? "" : ", ") + text + "}";
  sources_.push_back({name, type});
}

std::string Maker::add_node(const std::string& body, Type type, Turn turn) {
  const std::string id = "n" + std::to_string(node_count_++);
  nodes_ += (nodes_.empty() ? "" : ",\n  ") + in_quotes(id) + ": {" + body + "}";
  sources_.push_back({id, type, turn});
  return id;
}

std::string Maker::add_constant(Type type, const Range* range) {
  return add_node("\"type\": \"constant\", \"value\": " + literal(type, range) +
                      ", \"to\": " + in_quotes(graph::type_name(type)),
                  type, Turn::none);
}

Source* Maker::readable(Type type) {
  std::vector<size_t> found;
  for (size_t i = 0; i < sources_.size(); ++i) {
    const bool component = type == Type::floating && is_tuple(sources_[i].type);
    const bool swizzle = nodes::vector_types.has(type) && nodes::vector_types.has(sources_[i].type);
    if (sources_[i].type != type && !component && !swizzle) continue;
    found.insert(found.end(), sources_[i].fresh ? 3 : 1, i);
  }
  if (found.empty()) return nullptr;
  return &sources_[any(found)];
}

std::string Maker::linked(Source& source, Type type, const Range* range, Turn& turn) {
  std::string link = source.link;
  source.fresh = false;
  if (source.turn != Turn::none) turn = source.turn;
  const Turn own = source.turn;
  if (source.type != type) {
    const int from = graph::float_count(source.type), to = graph::float_count(type);
    link += ".";
    for (int i = 0; i < to; ++i) link += "xyzw"[below(static_cast<size_t>(from))];
  }
  return range == nullptr ? link : tamed(link, type, *range, own);
}

std::string Maker::tamed(const std::string& link, Type type, const Range& range, Turn turn) {
  if (chance(0.15)) return link;
  return add_node("\"type\": \"clamp\", \"in\": " + in_quotes(link) + ", \"low\": " + number(range.lo) +
                      ", \"high\": " + number(range.hi),
                  type, turn);
}

std::string Maker::argument(Type type, const Range* range, bool literals, Turn& turn) {
  const bool numbers = nodes::float_types.has(type);
  if (!literals || chance(0.75))
    if (Source* const source = readable(type))
      return in_quotes(linked(*source, type, numbers ? range : nullptr, turn));
  return literals ? literal(type, range) : in_quotes(add_constant(type, range));
}

bool Maker::allowed(const Row& row) const {
  if (row.is_sum() || row.is<nodes::Derivative>()) return false;
  if (row.is_summand())
    return row.is<nodes::Light>() == (kind_ == graph::DocumentKind::effect) &&
           kind_ != graph::DocumentKind::function;
  switch (row.availability()) {
    case nodes::Availability::anywhere: return true;
    case nodes::Availability::drawn: return kind_ != graph::DocumentKind::function;
    case nodes::Availability::effects: return kind_ == graph::DocumentKind::effect;
    case nodes::Availability::posts:
    case nodes::Availability::pictures: return kind_ == graph::DocumentKind::post;
  }
  return false;
}

const Range* tame_range(std::string_view row, size_t port) {
  for (const Tame& tame : tame_ports)
    if (tame.row == row && tame.port == port) return &tame.range;
  return nullptr;
}

void Maker::add_row() {
  const Row* row = nullptr;
  const bool special = kind_ != graph::DocumentKind::function && chance(0.4);
  do row = &any(nodes::table());
  while (!allowed(*row) || (special && row->availability() == nodes::Availability::anywhere));
  const std::vector<Example> examples = nodes::examples_of(*row);
  const Example example = any(examples);
  std::string body = "\"type\": " + in_quotes(row->name);
  Turn turn = row->is<nodes::Light>() ? Turn::light : row->is<nodes::TapIndex>() ? Turn::tap : Turn::none;
  bool settled[3] = {true, false, false};  // by Variable: whether something told the type
  for (const Port& port : row->ports)
    if (port.type.kind == PortType::Kind::type_name) settled[static_cast<size_t>(port.type.variable)] = true;
  for (size_t i = 0; i < row->ports.size(); ++i) {
    const Port& port = row->ports[i];
    std::string value;
    switch (port.type.kind) {
      case PortType::Kind::value: {
        const Type type = example.type_of(port.type);
        bool& known = settled[static_cast<size_t>(port.type.variable)];
        if (type == Type::filename) {
          value = "{\"link\": \"picture\"}";
          break;
        }
        if (known && !port.required(kind_ == graph::DocumentKind::effect) && chance(0.4)) continue;
        value = argument(type, tame_range(row->name, i), known || type == Type::floating, turn);
        known = true;
        break;
      }
      case PortType::Kind::type_name: value = in_quotes(graph::type_name(example.type_of(port.type))); break;
      case PortType::Kind::choice: {
        if (chance(0.5)) continue;
        const std::string_view choice = any(port.choices);
        if (choice == "trilinear") continue;  // asks for derivatives
        value = in_quotes(choice);
        break;
      }
      case PortType::Kind::component:
        value = port.type.variable == nodes::Variable::none
                    ? "0"
                    : std::to_string(below(
                          static_cast<size_t>(std::max(1, graph::float_count(example.type_of(port.type))))));
        break;
      case PortType::Kind::integer:
      case PortType::Kind::image: continue;
    }
    body += ", " + in_quotes(port.name) + ": " + value;
  }
  const std::string id = add_node(body, example.type_of(row->outputs[0].type), turn);
  if (row->outputs.size() == 1) return;
  sources_.pop_back();
  for (const nodes::Output& output : row->outputs)
    sources_.push_back({id + "." + std::string(output.name), example.type_of(output.type), turn});
}

void Maker::add_expression() {
  const Row& row = any(nodes::function_table());
  const std::vector<Example> examples = nodes::examples_of(row);
  if (examples.empty()) return;
  const Example example = any(examples);
  const bool is_word = std::isalpha(static_cast<unsigned char>(row.name[0])) != 0;
  std::string keys, list;
  std::vector<std::string> names;
  Turn turn = Turn::none;
  for (size_t i = 0; i < row.ports.size(); ++i) {
    const std::string name = "p" + std::to_string(i);
    const Type type = example.type_of(row.ports[i].type);
    keys +=
        ", " + in_quotes(name) + ": " + argument(type, tame_range(row.name, i), type == Type::floating, turn);
    list += (i == 0 ? "" : ", ") + name;
    names.push_back(name);
  }
  std::string code = std::string(row.name) + "(" + list + ")";
  if (row.name == "negate")
    code = "-" + names[0];
  else if (row.name == "!")
    code = "!" + names[0];
  else if (row.name == "?:")
    code = names[0] + " ? " + names[1] + " : " + names[2];
  else if (!is_word)
    code = names[0] + " " + std::string(row.name) + " " + names[1];
  add_node("\"type\": \"expression\", \"code\": " + in_quotes(code) + keys,
           example.type_of(row.outputs[0].type), turn);
}

void Maker::add_call() {
  const Callee& callee = any(callees(library_));
  std::string body = "\"type\": " + in_quotes(callee.name);
  Turn turn = Turn::none;
  for (const graph::Input& input : callee.inputs) {
    const Range range{input.min ? static_cast<double>(*input.min) : -10,
                      input.max   ? static_cast<double>(*input.max)
                      : input.min ? static_cast<double>(*input.min) + 10
                                  : 10};
    std::string value;
    if (!input.names.empty()) {
      value = std::to_string(below(input.names.size()));
    } else if (input.unit) {
      Turn own = Turn::none;
      const std::string vector = argument(input.type, nullptr, false, own);
      if (own != Turn::none) turn = own;
      value = in_quotes(add_node("\"type\": \"normalize\", \"in\": " + vector, input.type, own));
    } else {
      value = argument(input.type, &range, true, turn);
    }
    body += ", " + in_quotes(input.name) + ": " + value;
  }
  const std::string id = add_node(body, callee.outputs[0].second, turn);
  if (callee.outputs.size() == 1) return;
  sources_.pop_back();
  for (const auto& [name, type] : callee.outputs) sources_.push_back({id + "." + name, type, turn});
}

/// Sums what depends on the light or the tap, so that outputs may read it.
void Maker::add_sum() {
  std::vector<size_t> found;
  for (size_t i = 0; i < sources_.size(); ++i)
    if (sources_[i].turn != Turn::none && nodes::float_types.has(sources_[i].type)) found.push_back(i);
  std::string link;
  Type type = Type::floating;
  if (found.empty()) {
    Source* const source = readable(type);
    if (source == nullptr) return;
    Turn turn = Turn::none;
    link = linked(*source, type, nullptr, turn);
  } else {
    Source& source = sources_[any(found)];
    type = source.type;
    Turn turn = Turn::none;
    link = linked(source, type, nullptr, turn);
  }
  if (kind_ == graph::DocumentKind::effect) {
    add_node("\"type\": \"sum_lights\", \"in\": " + in_quotes(link), type, Turn::none);
    return;
  }
  const int first = -static_cast<int>(below(4)), last = first + static_cast<int>(below(chance(0.1) ? 64 : 6));
  add_node("\"type\": \"sum_taps\", \"in\": " + in_quotes(link) + ", \"first\": " + std::to_string(first) +
               ", \"last\": " + std::to_string(last),
           type, Turn::none);
}

void Maker::add_outputs() {
  if (kind_ == graph::DocumentKind::function) {
    const size_t count = 1 + below(3);
    std::string outputs;
    for (size_t i = 0; i < count; ++i) {
      // What was made last depends on the most.
      const size_t from =
          chance(0.6) && sources_.size() > 4 ? sources_.size() - 4 : static_cast<size_t>(input_count_);
      const Source& source = sources_[from + below(sources_.size() - from)];
      outputs += (i == 0 ? "" : ", ") + in_quotes("o" + std::to_string(i)) + ": " + in_quotes(source.link);
    }
    rest_ = "\"outputs\": {" + outputs + "}";
    return;
  }
  add_sum();
  std::erase_if(sources_, [](const Source& s) { return s.turn != Turn::none; });
  std::string body = "\"type\": \"combine4\", \"to\": \"color4\"";
  Turn turn = Turn::none;
  for (int i = 1; i <= 4; ++i)
    body += ", \"in" + std::to_string(i) + "\": " + argument(Type::floating, nullptr, true, turn);
  const std::string id = add_node(body, Type::color4, Turn::none);
  rest_ = kind_ == graph::DocumentKind::post
              ? "\"outputs\": {\"color\": " + in_quotes(id) + "}"
              : "\"passes\": [{\"name\": \"base\", \"color\": " + in_quotes(id) + "}]";
}

std::string Maker::run() {
  const size_t count = 1 + below(4);
  for (size_t i = 0; i < count; ++i) add_input();
  const size_t wanted = 2 + below(chance(0.2) ? 14 : 6);
  const bool is_effect = kind_ == graph::DocumentKind::effect;
  if (is_effect) inputs_ += ", \"picture\": {\"type\": \"filename\", \"value\": \"\"}";
  for (size_t i = 0; i < wanted; ++i) {
    const double kind = unit();
    if (kind < 0.6)
      add_row();
    else if (kind < 0.9)
      add_expression();
    else if (kind < 0.95 || kind_ == graph::DocumentKind::function)
      add_call();
    else
      add_sum();
  }
  add_outputs();
  constexpr std::string_view kinds[] = {"function", "effect", "post"};
  const std::string_view kind = kinds[static_cast<size_t>(kind_)];
  const std::string inputs = kind_ == graph::DocumentKind::function ? "inputs" : "parameters";
  return "{\"isoshade\": 1, " + in_quotes(kind) + ": \"random\",\n " + in_quotes(inputs) + ": {" + inputs_ +
         "},\n \"nodes\": {" + nodes_ + "},\n " + rest_ + "}\n";
}

}  // namespace

std::string random_document(uint64_t seed, const std::string& library) { return Maker(seed, library).run(); }

}  // namespace isoshade::accuracy
