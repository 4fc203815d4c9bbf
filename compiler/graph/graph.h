// SPDX-License-Identifier: Apache-2.0
// The graph of one document as its author wrote it: shape and names are checked, links and types are not.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <variant>
#include <vector>

#include "compiler/graph/document.h"
#include "compiler/interface/pass_state.h"

namespace isoshade::graph {

enum class DocumentKind : uint8_t { function, effect, post, scene };

std::string_view kind_name(DocumentKind kind);

/// The kind of a document, after its version was checked. Reports a root that is no object, a missing or
/// wrong "isoshade": 1, and a document that has not exactly one of the keys function, effect, post, scene.
std::optional<DocumentKind> document_kind(const Document& document, support::Diagnostics& diagnostics);

enum class Type : uint8_t {
  boolean,
  integer,
  floating,  ///< "float"
  vector2,
  vector3,
  vector4,
  color3,
  color4,
  matrix33,
  matrix44,
  filename,
  string,
};

std::string_view type_name(Type type);
/// How a document writes the type of inputs that each call settles.
inline constexpr std::string_view any_type_name = "any";
std::optional<Type> find_type(std::string_view name);
std::vector<std::string_view> all_type_names();
/// Floats in a value of the type: 1, 2, 3, 4, 9 or 16; 0 if it is not made of floats.
int float_count(Type type);

/// Names of inputs, parameters, nodes, ports, passes: [A-Za-z_][A-Za-z0-9_]{0,127}.
bool is_id(std::string_view text);

/// A range of bytes in the document; Graph::span makes a Span of it.
struct TextRange {
  uint32_t begin = 0, end = 0;
};

/// A value written in the document. Floats are rounded once from the text, denormals are zeros; none is NaN
/// or infinite.
struct Literal {
  enum class Kind : uint8_t { boolean, number, numbers, string };
  Kind kind = Kind::number;
  bool boolean = false;
  bool integral = false;       ///< a number written without fraction or exponent that fits int64
  float number = 0;            ///< of a number
  int64_t integer = 0;         ///< of an integral number
  std::vector<float> numbers;  ///< of an array: at most max_literal_numbers
  std::string string;
};

inline constexpr size_t max_literal_numbers = 16;  ///< a matrix has so many

/// Reports what is no literal; `key` is what messages call it.
std::optional<Literal> parse_literal(const Document& document, const Json& json, std::string_view key,
                                     support::Diagnostics& diagnostics);

/// "node", "node.port", "node.xyz" or "node.port.xyz", taken apart at the dots but not resolved.
struct Link {
  static constexpr uint32_t unresolved = ~0u;

  std::string name;                    ///< of a node, input or parameter
  std::vector<std::string> selectors;  ///< at most two: an output port, a swizzle, or both in this order
  TextRange place;                         ///< of the string
  uint32_t node = unresolved;          ///< or inside of an expression, the node itself
};

/// What stands in a port. A string is a Literal here: in a port of type string or filename it is the text
/// itself, and parse_link makes the link that it is elsewhere. {"link": "x"} is a Link.
struct Port {
  std::string name;
  std::variant<Literal, Link> value;
  TextRange name_place, place;
  std::string shown = {};  ///< inside of an expression: "the left side"
};

struct Node {
  /// What an author wrote for it.
  enum class Origin : uint8_t {
    node,       ///< a node
    operation,  ///< an operator, a constructor or a name in an expression
    call        ///< name(...) in an expression: its ports are called by their position, from "1"
  };
  std::string id, type, doc;  ///< type: of the node library, or a function document's name or path
  std::vector<Port> ports;    ///< in the order written
  TextRange id_place, type_place, place;
  Origin origin = Origin::node;
  std::string shown = {};  ///< inside of an expression: "*"; else its type tells
  /// "doc" and "extras" as ports: they are that only where the type is a function with inputs of these names.
  std::vector<Port> free_keys = {};

  /// How messages name what it is.
  const std::string& label() const { return origin == Origin::node ? type : shown; }
};

/// The nodes that the code of one node stands for: nodes[root] and those of [first, end).
struct Expression {
  uint32_t root = 0, first = 0, end = 0;
  std::string code;
  std::vector<Port> ports;
};

/// An input of a function, or a parameter of an effect or post.
struct Input {
  std::string name, doc;
  Type type = Type::floating;
  bool any = false;               ///< of a function: float, a vector or a colour, as the call has it
  bool unit = false;              ///< of a function, a vector: its length is 1
  std::optional<Literal> value;   ///< always there in a parameter; fits the type and the range
  std::optional<float> min, max;  ///< of each component
  std::vector<std::string>
      names;  ///< of the values 0, 1, ... of an integer, which has no others then; or none
  TextRange name_place, place, value_place;
};

/// An output of a function ("out", ...) or post ("color").
struct Output {
  std::string name;
  Link link;
  TextRange name_place;
};

/// What the coordinates of a pass's `position` count from.
enum class PositionSpace : uint8_t { world, object, view };

/// One drawing of the mesh by an effect.
struct Pass {
  std::string name;
  interface::PassState state;
  std::optional<Link> position;  ///< vertex output; without it the mesh's own position
  PositionSpace position_space = PositionSpace::world;
  std::optional<uint32_t> enabled;  ///< in Graph::inputs: it is drawn where that parameter is not 0
  Link color;                       ///< surface output
  TextRange place;
};

/// The output of a post, and the image that it goes over.
inline constexpr std::string_view post_output = "color";

/// An image that a post reads beside the one that it goes over.
struct InputImage {
  std::string name;
  TextRange place;
};

struct Graph {
  support::Source source;
  DocumentKind kind = DocumentKind::function;  ///< never scene
  std::string name, doc;
  TextRange name_place;
  std::vector<Input> inputs;
  std::vector<Node> nodes;
  std::vector<Output> outputs;          ///< of a function or post, at least one
  std::vector<Pass> passes;             ///< of an effect, at least one
  std::vector<InputImage> images = {};  ///< of a post
  std::optional<uint32_t> enabled =
      {};  ///< of a post: the parameter in `inputs` that is 0 where it does nothing
  std::vector<Expression> expressions = {};
  uint32_t expression_nodes = 0;  ///< that expressions stand for, beside the nodes that were written

  /// Inputs and nodes share their names.
  struct Name {
    bool is_input;
    uint32_t index;
  };
  std::unordered_map<std::string, Name> names;

  support::Span span(TextRange place) const { return {source, place.begin, place.end}; }
  /// Whether it has inputs of any type: these are all of one type, which each call settles.
  bool is_generic() const { return std::ranges::any_of(inputs, &Input::any); }
};

/// Reports everything wrong with the shape of a function, effect or post document.
std::optional<Graph> build_graph(const Document& document, support::Diagnostics& diagnostics);

/// Takes a string apart as a link; reports one that has not the form of a link.
std::optional<Link> parse_link(const support::Source& source, std::string_view text, TextRange place,
                               support::Diagnostics& diagnostics);

/// The number that is meant by the name of one of an input's values, as a literal; nothing for other names.
std::optional<Literal> named_value(const std::vector<std::string>& names, std::string_view name);

/// For messages about the values of an integer that have names: "it is 0 (soft), 1 (hard) or 2 (none)".
std::string described_names(const std::vector<std::string>& names);

/// For messages about a number outside of a range: a limit as a value of the type is written.
std::string limit_text(Type type, float limit);

/// Whether a literal is a value of the type as it stands: a boolean, an integer in 32 bits, a number, an
/// array of as many numbers as the type has floats, a string.
bool fits(Type type, const Literal& literal);

}  // namespace isoshade::graph
