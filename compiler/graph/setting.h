// SPDX-License-Identifier: Apache-2.0
// Settings: values for documents that are given as text, as `--set` takes them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "compiler/graph/document.h"
#include "compiler/graph/graph.h"

namespace isoshade::graph {

/// `key=value` or `name.key=value`. The views are into the text that was parsed.
struct Setting {
  std::string_view text;  ///< as given
  std::string_view name;  ///< empty if only a key is given
  std::string_view key;
  support::Source source;  ///< name.key=value, the value as JSON
  Json value;              ///< in `source`
};

/// The value is JSON, or numbers with commas between them ("1,0.5,0"), or a plain word. Reports a text of another form;
/// `example` shows in the report how one looks.
std::optional<Setting> parse_setting(std::string_view text, std::string_view example, support::Diagnostics& diagnostics);

/// A value for a parameter of an effect or a post. Who uses it checks whether there is such a parameter, and whether the
/// value fits.
struct GivenParameter {
  std::string name;
  Literal value;
  support::Span name_where, value_where;
};

/// A setting `parameter=value` of an effect or a post. Reports one that is malformed.
std::optional<GivenParameter> parse_given_parameter(std::string_view text, support::Diagnostics& diagnostics);

}  // namespace isoshade::graph
