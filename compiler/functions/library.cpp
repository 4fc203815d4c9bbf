// SPDX-License-Identifier: Apache-2.0
#include "compiler/functions/library.h"

#include <algorithm>
#include <tuple>
#include <type_traits>
#include <utility>

#include "compiler/functions/all.h"
#include "compiler/functions/calls.h"
#include "compiler/functions/signatures.h"
#include "compiler/support/assert.h"
#include "compiler/support/name_table.h"

namespace isoshade::functions {

namespace {

using namespace traced;

// The body of a row as a type. `run` calls the template, never the recording overload of the same name.
#define FUNCTION(name, signature, ulp_, domain, reference, unit_) \
  struct Body_##name {                                            \
    using Variants = Signatures<Float>::signature;                \
    static constexpr bool on_floats = #signature[0] == 'g';       \
    static constexpr Accuracy accuracy{ulp_, #unit_};             \
    template <class... T>                                         \
    static auto run(T... arguments) {                             \
      return functions::name(arguments...);                       \
    }                                                             \
  };
#include "compiler/functions/functions.def"

// The body of a row in a tier.
#define TIER(tier_, name, ulp_, domain, unit_)        \
  struct Body_##tier_##_##name : Body_##name {        \
    static constexpr Tier tier = Tier::tier_;         \
    static constexpr Accuracy accuracy{ulp_, #unit_}; \
    template <class... T>                             \
    static auto run(T... arguments) {                 \
      return tier_::name(arguments...);               \
    }                                                 \
  };
#include "compiler/functions/functions.def"

template <class Body, class... T>
void build(ir::Builder& b) {
  std::vector<ir::ValueId> parameters;
  for (size_t i = 0; i < b.function().parameters.size(); ++i) parameters.push_back(b.parameter(i));
  std::span<const ir::ValueId> rest(parameters);
  std::tuple<T...> arguments{Flat<T>::take(b, rest)...};
  const auto result = std::apply([](T... a) { return Body::run(a...); }, arguments);
  std::vector<ir::ValueId> results;
  Flat<std::remove_const_t<decltype(result)>>::values(b, result, results);
  b.finish(results);
}

template <class T>
constexpr std::string_view code = "f";
template <int N>
constexpr std::string_view code<V<N>> = N == 2   ? "v2"
                                        : N == 3 ? "v3"
                                                 : "v4";
template <int N>
constexpr std::string_view code<M<N>> = N == 3 ? "m3" : "m4";

/// The row's name, followed by the types of its arguments, or by one type if all are equal; floats add nothing.
template <class First, class... Rest>
std::string variant_name(std::string_view row) {
  std::string name(row);
  if (code<First> == "f") return name;
  name.append("_").append(code<First>);
  if (!(std::is_same_v<First, Rest> && ...)) (name.append(code<Rest>), ...);
  return name;
}

template <class Body, class... T>
void add_variant(std::vector<Variant>& out, std::string_view row, Types<T...>) {
  Variant variant;
  variant.row = row;
  (Flat<T>::types(variant.parameters), ...);
  Flat<decltype(Body::run(std::declval<T>()...))>::types(variant.results);
  variant.name = variant_name<T...>(row);
  variant.bodies.fill(&build<Body, T...>);
  variant.accuracy.fill(Body::accuracy);
  out.push_back(std::move(variant));
}

template <class Body, class... Variants>
void add_row(std::vector<Variant>& out, std::string_view row, Types<Variants...>) {
  (add_variant<Body>(out, row, Variants{}), ...);
}

template <class Body, class... T>
void set_body(Variant& variant, Types<T...>) {
  variant.bodies[static_cast<size_t>(Body::tier)] = &build<Body, T...>;
}

void set_accuracy(std::vector<Variant>& table, std::string_view row, Tier tier, const Accuracy& accuracy) {
  for (Variant& variant : table)
    if (variant.row == row) variant.accuracy[static_cast<size_t>(tier)] = accuracy;
}

/// Vector variants of rows defined on floats call the float variant for each component, so they follow its tier.
template <class Body, class First, class... Rest>
void add_tier(std::vector<Variant>& table, std::string_view row, Types<First, Rest...>) {
  auto variant = std::ranges::find(table, row, &Variant::row);
  support::assert_that(variant != table.end(), row);
  set_accuracy(table, row, Body::tier, Body::accuracy);
  set_body<Body>(*variant, First{});
  if constexpr (!Body::on_floats) (set_body<Body>(*++variant, Rest{}), ...);
}

struct Domain {
  std::string_view tier, row, text;
};
constexpr Domain domains[] = {
#include "domains.inc"
};

std::string_view domain_text(std::string_view row, Tier tier) {
  for (const Domain& domain : domains)
    if (domain.row == row && domain.tier == tier_name(tier)) return domain.text;
  return {};
}

}  // namespace

const std::vector<Variant>& variants() {
  static const std::vector<Variant> table = [] {
    std::vector<Variant> rows;
#define FUNCTION(name, signature, ulp, domain, reference, unit) \
  add_row<Body_##name>(rows, #name, Body_##name::Variants{});
#include "compiler/functions/functions.def"
#define TIER(tier, name, ulp, domain, unit) \
  add_tier<Body_##tier##_##name>(rows, #name, Body_##name::Variants{});
#define FOLLOWS(tier, name, ulp, domain, unit) set_accuracy(rows, #name, Tier::tier, {ulp, #unit});
#include "compiler/functions/functions.def"
    return rows;
  }();
  return table;
}

const Variant* find(std::string_view row, std::span<const ir::Type> arguments) {
  const std::vector<Variant>& all = variants();
  // By row, its first variant; the others stand behind it.
  static const support::NameTable rows = [] {
    support::NameTable table;
    for (size_t i = 0; i < variants().size(); ++i)
      if (const auto [index, is_new] = table.add(variants()[i].row); is_new) table.number(index) = static_cast<int>(i);
    return table;
  }();
  const size_t found = rows.find(row);
  if (found == support::NameTable::npos) return nullptr;
  for (auto i = static_cast<size_t>(rows.number(found)); i < all.size() && all[i].row == row; ++i)
    if (std::ranges::equal(all[i].parameters, arguments)) return &all[i];
  return nullptr;
}

uint32_t declare(ir::Module& module, const Variant& variant) {
  for (uint32_t i = 0; i < module.functions.size(); ++i)
    if (module.functions[i].library == variant.name) return i;
  ir::Function function;
  function.name = "iso_" + variant.name;  // cannot clash with names of GLSL, C++ or documents
  function.library = variant.name;
  constexpr std::string_view letters = "abcdefgh";
  for (size_t i = 0; i < variant.parameters.size(); ++i)
    function.parameters.push_back({std::string(1, letters[i]), variant.parameters[i], "", false});
  for (size_t i = 0; i < variant.results.size(); ++i)
    function.results.push_back(
        {variant.results.size() == 1 ? "out" : "out" + std::to_string(i), variant.results[i]});
  module.functions.push_back(std::move(function));
  return static_cast<uint32_t>(module.functions.size() - 1);
}

std::vector<ir::ValueId> call_library(ir::Builder& builder, std::string_view row,
                                      std::span<const ir::ValueId> arguments) {
  std::vector<ir::Type> types;
  for (ir::ValueId argument : arguments) types.push_back(builder.type(argument));
  const Variant* variant = find(row, types);
  if (variant == nullptr) support::bug("there is no library function " + std::string(row) + " for these argument types");
  return builder.call(declare(builder.module(), *variant), arguments);
}

const Variant& variant_of(const ir::Function& declaration) {
  for (const Variant& variant : variants())
    if (variant.name == declaration.library) return variant;
  support::bug("the library has no function for the declaration " + declaration.name);
}

void expand(ir::Module& module, Tier tier) {
  // Bodies append declarations of the functions that they call.
  for (uint32_t i = 0; i < module.functions.size(); ++i) {
    // What has no body and is not of the library, the program defines that links the module.
    if (!module.functions[i].is_declaration() || module.functions[i].library.empty()) continue;
    const Variant& variant = variant_of(module.functions[i]);
    ir::Builder builder(module, i);
    variant.body(tier)(builder);
  }
}

std::string_view domain_of(std::string_view row, Tier tier) {
  const std::string_view own = domain_text(row, tier);
  return own.empty() ? domain_text(row, Tier::standard) : own;
}

}  // namespace isoshade::functions
