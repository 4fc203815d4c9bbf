// SPDX-License-Identifier: Apache-2.0
// Pure shaders: structs and functions that other programs link, without a stage around them. What comes from outside is
// asked of the host (interface/host.def).
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compiler/emit/printer.h"
#include "compiler/interface/host.h"
#include "compiler/ir/module.h"
#include "compiler/lower/lower.h"

namespace isoshade::emit {

/// What a function of a pure shader computes.
enum class PureKind : uint8_t { shade, move_vertex, coverage, post_process, function };

struct PureFunction {
  PureKind kind{};
  uint32_t entry = 0;                        ///< in the module
  std::vector<interface::Binding> bindings;  ///< of its parameters, before those that derivatives add
};

/// A field of a struct of a pure shader.
struct PureField {
  std::string name;  ///< in emitted text
  ir::Parameter parameter;
};

/// A document that is compiled to be linked.
struct PureShader {
  std::string name;      ///< of the document
  std::string document;  ///< its name in its collection
  std::string prefix;    ///< of the names in GLSL, the namespace in C++
  std::string tier;      ///< "fast", "precise", or empty for the default
  ir::Module module;     ///< optimised; functions of the host have no body
  std::vector<PureFunction> functions;
  std::vector<PureField> parameters;                    ///< of the struct Parameters: of the whole document
  std::map<std::string, interface::HostFunction> host;  ///< by name in the module
};

/// What the shader's names in GLSL begin with: the prefix and one underscore, for GLSL ES reserves two in a row.
std::string name_prefix(const PureShader& shader);
/// The structs of the parameters, and of the results of a function document that has several.
inline constexpr std::string_view parameters_record = "Parameters", results_record = "Result";
/// The struct whose fields a function is given for each point that it is called for. Kinds with the same struct take the
/// same points.
std::string_view point_record(PureKind kind);
/// Its fields: all that the functions that take it read, with the derivatives that they need.
std::vector<PureField> point_fields(const PureShader& shader, PureKind kind);
/// The fields of results_record.
std::vector<PureField> result_fields(const PureShader& shader, const PureFunction& function);
/// The name of a function in GLSL. In C++ it is the same in the namespace, without the prefix.
std::string function_name(const PureShader& shader, const PureFunction& function, bool with_prefix);
/// What functions of the shader ask their host for, in the order of host.def.
std::vector<interface::HostCall> host_calls(const PureShader& shader,
                                            std::span<const PureFunction> functions);
/// What all of its functions ask for.
inline std::vector<interface::HostCall> host_calls(const PureShader& shader) {
  return host_calls(shader, shader.functions);
}

/// How a language writes what stands around the functions of a pure shader.
class PureLanguage {
 public:
  virtual ~PureLanguage() = default;
  virtual const Language& language() const = 0;
  /// Whether names begin with the shader's prefix; otherwise they stand in a namespace of that name.
  virtual bool has_prefix() const = 0;
  /// Everything before the shared functions: guards, inclusions, prototypes of the host's functions. `signatures`: of the
  /// shader's own functions, for its readers. `hash`: of what stands behind.
  virtual std::string head(const PureShader& shader, const std::vector<std::string>& signatures,
                           const std::vector<interface::HostCall>& calls, bool has_hidden_zero,
                           uint32_t hash) const = 0;
  /// The shared functions, and what stands between them and the shader's own.
  virtual std::string shared(const PureShader& shader, const std::string& functions) const = 0;
  virtual std::string tail(const PureShader& shader, uint32_t hash) const = 0;
};

/// The whole text.
std::string print_pure(const PureShader& shader, const PureLanguage& language);

}  // namespace isoshade::emit
