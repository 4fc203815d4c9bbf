// SPDX-License-Identifier: Apache-2.0
// A reflection: all that a program needs to know in order to bind a shader by hand. Its records are those of
// reflection.def; format.h says what they are in JSON.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/graph/graph.h"
#include "compiler/interface/layout.h"
#include "compiler/interface/pass_state.h"

namespace isoshade::reflect {

using Text = std::string;
using Integer = int64_t;
using Real = double;
using Float = float;  ///< of a document; written as the shortest number for it
using Boolean = bool;
template <class T>
using Optional = std::optional<T>;
template <class T>
using List = std::vector<T>;

/// One of the words that `words()` lists: names that are declared elsewhere.
template <std::vector<std::string_view> (*list)()>
struct Word {
  std::string text;

  static std::vector<std::string_view> words() { return list(); }
  friend bool operator==(const Word&, const Word&) = default;
};

namespace words {
std::vector<std::string_view> kinds();       ///< of documents, but scenes
std::vector<std::string_view> types();       ///< of documents
std::vector<std::string_view> ir_types();    ///< "bool", "int", "float", "vec2", ...
std::vector<std::string_view> tiers();       ///< of precision
std::vector<std::string_view> divisions();   ///< of GLSL
std::vector<std::string_view> attributes();  ///< of a surface
std::vector<std::string_view> spaces();
std::vector<std::string_view> filters();  ///< of the node `image`
std::vector<std::string_view> wraps();
std::vector<std::string_view> host_functions();
std::vector<std::string_view> stages();
std::vector<std::string_view> vertex_fields();  ///< of interface/records.def
std::vector<std::string_view> skips();  ///< of interface/skips.def
}  // namespace words

using KindName = Word<words::kinds>;
using TypeName = Word<words::types>;
using IrTypeName = Word<words::ir_types>;
using TierName = Word<words::tiers>;
using DivisionName = Word<words::divisions>;
using AttributeName = Word<words::attributes>;
using SpaceName = Word<words::spaces>;
using FilterName = Word<words::filters>;
using WrapName = Word<words::wraps>;
using HostName = Word<words::host_functions>;
using StageName = Word<words::stages>;
using VertexFieldName = Word<words::vertex_fields>;
using SkipName = Word<words::skips>;

/// The version of the format. It changes when a reader of the one before could misread a file.
struct Version {
  static constexpr int number = 1;
};

/// The default of a parameter.
struct Value {
  graph::Type type;
  graph::Literal literal;
};

/// A key for each row of interface::pass_states().
struct PassStates {
  interface::PassState state;
};

#define CHOICES(Name) enum class Name : uint8_t {
#define CHOICE(name, doc) name,
#define END_CHOICES(Name) };
#define RECORD(Name, title, doc) struct Name {
#define FIELD(type, member, key, doc) type member{};
#define END_RECORD(Name) };
#include "compiler/reflect/reflection.def"

/// The reflection as JSON, with a line break at the end.
std::string json(const Reflection& reflection);
/// The JSON Schema (draft-07) of all reflections; no record may have a key that reflection.def does not list.
std::string schema();
/// The tables of graphs/README.md, one for each record.
std::string markdown();

}  // namespace isoshade::reflect
