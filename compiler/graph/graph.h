// SPDX-License-Identifier: Apache-2.0
// The graph of one document as its author wrote it: structure and names are checked, links and types are not.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "compiler/graph/document.h"
#include "compiler/interface/pass_state.h"
#include "compiler/support/name_table.h"

namespace isoshade::graph {

enum class DocumentKind : uint8_t { function, effect, post, scene, image };

std::string_view kind_name(DocumentKind kind);
/// "an effect"
std::string with_article(DocumentKind kind);

/// Checks the version and returns the kind of a document. Reports a root that is not an object, a missing or
/// wrong "isoshade": 1, and a document without exactly one of the keys function, effect, post, scene, image.
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
/// The type name of generic inputs, whose type is inferred at each call.
inline constexpr std::string_view any_type_name = "any";
std::optional<Type> find_type(std::string_view name);
std::vector<std::string_view> all_type_names();
/// The number of floats in a value of the type: 1, 2, 3, 4, 9 or 16; 0 if it does not consist of floats.
int float_count(Type type);

/// Whether `text` is a valid name of an input, parameter, node, port or pass: [A-Za-z_][A-Za-z0-9_]{0,127}.
bool is_id(std::string_view text);

/// A byte range in the document or in one that it extends; Graph::span makes it a Span.
struct TextRange {
  uint32_t begin = 0, end = 0;
  uint32_t source = 0;  ///< as Json::source
};

/// A literal value in the document. Floats are rounded once from the text, denormals flush to zero; all are
/// finite.
struct Literal {
  enum class Kind : uint8_t { boolean, number, numbers, string };
  Kind kind = Kind::number;
  bool boolean = false;
  bool integral = false;       ///< the number has no fraction or exponent and fits int64
  float number = 0;            ///< of a number
  int64_t integer = 0;         ///< of an integral number
  std::vector<float> numbers;  ///< of an array: at most max_literal_numbers
  std::string string;
};

inline constexpr size_t max_literal_numbers = 16;  ///< a 4x4 matrix

/// Reports a value that is not a literal; `key` names it in messages.
std::optional<Literal> parse_literal(const Document& document, const Json& json, std::string_view key,
                                     support::Diagnostics& diagnostics);

/// "node", "node.port", "node.xyz" or "node.port.xyz", split at the dots but not resolved.
struct Link {
  static constexpr uint32_t unresolved = ~0u;

  std::string name;                    ///< of a node, input or parameter
  std::vector<std::string> selectors;  ///< an output port, a swizzle, or both in this order
  TextRange place;                     ///< of the string
  uint32_t node = unresolved;          ///< set instead of `name` inside an expression
};

/// The value of a port. A string is a Literal here: ports of type string and filename use it as text, all others
/// parse it with parse_link. {"link": "x"} is a Link.
struct Port {
  std::string name;
  std::variant<Literal, Link> value;
  TextRange name_place, place;
  std::string shown = {};  ///< its name in messages inside an expression: "the left side"
};

struct Node {
  /// What the author wrote.
  enum class Origin : uint8_t {
    node,       ///< a node
    operation,  ///< an operator, a constructor or a name in an expression
    call        ///< an operator or name(...) in an expression; its ports are numbered from "1"
  };
  std::string id, type, doc;  ///< type: a row of the node library, or the name or path of a function document
  std::vector<Port> ports;    ///< in document order
  TextRange id_place, type_place, place;
  Origin origin = Origin::node;
  std::string shown = {};  ///< its name in messages inside an expression: "*"
  /// The keys "doc" and "extras" as ports, for functions with inputs of these names.
  std::vector<Port> free_keys = {};

  /// Its type, as messages name it.
  const std::string& label() const { return origin == Origin::node ? type : shown; }
};

/// The nodes that one expression expands to: nodes[root] and nodes[first] to nodes[end - 1].
struct Expression {
  uint32_t root = 0, first = 0, end = 0;
  std::string code;
  std::vector<Port> ports;
};

/// An input of a function, or a parameter of an effect or post.
struct Input {
  std::string name, doc;
  Type type = Type::floating;
  bool any = false;                ///< generic: each call infers float, a vector or a colour (functions only)
  bool unit = false;               ///< a vector of length 1 (functions only)
  bool dynamic = false;            ///< programs are never compiled for one value of it (parameters only)
  std::optional<Literal> value;    ///< the default; parameters always have one; fits the type and the range
  std::optional<float> min, max;   ///< of each component
  std::vector<std::string> names;  ///< of the values 0, 1, ... of an integer ("enum"); empty if it has none
  TextRange name_place, place, value_place;
};

/// An output of a function ("out", ...) or post ("color").
struct Output {
  std::string name;
  Link link;
  TextRange name_place;
};

/// The coordinate space of a pass's `position`.
enum class PositionSpace : uint8_t { world, object, view };

/// The cutoff of a cut-out that names none.
inline constexpr float default_cutoff = 0.5f;

/// One pass of an effect over the mesh.
struct Pass {
  std::string name;
  interface::PassState state;
  std::optional<Link> position;  ///< vertex output; default: the position of the mesh
  PositionSpace position_space = PositionSpace::world;
  std::optional<uint32_t> enabled;  ///< in Graph::inputs: the pass is drawn if this parameter is not 0
  std::optional<uint32_t> double_sided;  ///< in Graph::inputs: no face is culled if this parameter is not 0
  std::optional<uint32_t> blended;  ///< in Graph::inputs: the pass is opaque if this parameter is 0
  interface::Repeat repeat;
  std::optional<Link> cutout;  ///< the pass is drawn where it holds: a boolean, or a float of at least `cutoff`
  std::optional<Link> cutoff;  ///< of a float; 0 and less: drawn everywhere
  bool casts_shadow = true;    ///< whether lights that have shadows draw it into them
  bool casts_blended_shadow = false;  ///< whether they do so where it is blended, too
  bool receives_shadow = true;
  Link color;                  ///< surface output
  TextRange place;
};

/// The name of a post's output and of the image that it processes.
inline constexpr std::string_view post_output = "color";
/// The name of the further image that posts have which use the node of this name: how far things have moved.
inline constexpr std::string_view motion_image_name = "motion";

/// A further image that a post reads.
struct InputImage {
  std::string name;
  TextRange place;
};

/// What names stand for.
class NameMap {
 public:
  /// An input or a node.
  struct Name {
    bool is_input;
    uint32_t index;
  };

  /// False if the name stands for something already; then it still does.
  bool add(std::string_view name, Name meaning) {
    const auto [index, is_new] = table_.add(name);
    if (is_new) table_.number(index) = static_cast<int>(2 * meaning.index + (meaning.is_input ? 1 : 0));
    return is_new;
  }
  std::optional<Name> find(std::string_view name) const {
    const size_t index = table_.find(name);
    if (index == support::NameTable::npos) return std::nullopt;
    const auto number = static_cast<uint32_t>(table_.number(index));
    return Name{number % 2 != 0, number / 2};
  }
  /// Of a name that is there.
  Name at(std::string_view name) const { return find(name).value(); }
  bool contains(std::string_view name) const { return table_.contains(name); }
  void reserve(size_t count) { table_.reserve(count); }

 private:
  support::NameTable table_;
};

struct Graph {
  support::Source source;
  std::vector<support::Source> bases = {};  ///< the documents that it extends: sources 1, 2, ... of places
  DocumentKind kind = DocumentKind::function;  ///< never scene or image
  std::string name, doc;
  TextRange name_place;
  std::vector<Input> inputs;
  std::vector<Node> nodes;
  std::vector<Output> outputs;           ///< of a function or post, at least one
  std::vector<Pass> passes;              ///< of an effect, at least one
  std::vector<InputImage> images = {};   ///< of a post
  std::optional<uint32_t> enabled = {};  ///< in `inputs`: a post is skipped if this parameter is 0
  std::vector<Expression> expressions = {};
  uint32_t expression_nodes = 0;  ///< the number of nodes that expressions were expanded to

  using Name = NameMap::Name;
  NameMap names;  ///< inputs and nodes share one namespace

  support::Span span(TextRange place) const {
    return {place.source == 0 ? source : bases[place.source - 1], place.begin, place.end};
  }
  /// Whether it has generic inputs ("any"). They all have the same type, inferred at each call.
  bool is_generic() const { return std::ranges::any_of(inputs, &Input::any); }
};

/// Reads a function, effect or post document and reports all errors in its structure.
std::optional<Graph> build_graph(const Document& document, support::Diagnostics& diagnostics);

/// Parses a string as a link; reports a malformed one at `where`, which is `place` as a Span.
std::optional<Link> parse_link(std::string_view text, TextRange place, const support::Span& where,
                               support::Diagnostics& diagnostics);

/// The integer value called `name` ("enum"), as a literal; nullopt if there is none.
std::optional<Literal> named_value(const std::vector<std::string>& names, std::string_view name);

/// A note that lists the named values of an integer: "it is 0 (soft), 1 (hard) or 2 (none)".
std::string described_names(const std::vector<std::string>& names);

/// A limit of a range as text, formatted as a value of the type.
std::string limit_text(Type type, float limit);

/// Whether a literal is a value of the type without conversion: a boolean, a 32-bit integer, a number, an array
/// with as many numbers as the type has floats, a string.
bool fits(Type type, const Literal& literal);

}  // namespace isoshade::graph
