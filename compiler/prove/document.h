// SPDX-License-Identifier: Apache-2.0
// What `isoshade check` asks of a document: the tapes of what it computes, over the inputs that it allows.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "compiler/check/typed_graph.h"
#include "compiler/interface/binding.h"
#include "compiler/lower/lower.h"
#include "compiler/prove/prove.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::prove {

/// Inputs without "min" or "max" go so far, and so do positions; see graphs/README.md for what else is assumed.
inline constexpr double default_limit = interface::assume::limit;

/// One thing that a document computes: a function, or the colour of a pass, where it moves vertices to, or where it is
/// drawn.
struct Subject {
  std::string name;  ///< of a function or post, its own; else "pass base", "pass outline, position", "pass base, cutout"
  Tape tape;
  lower::NodesOfOrigins nodes;     ///< where the places of the tape are
  interface::Interface interface;  ///< of the tape's module
};

/// Changes what is lowered of a document, or of a pass of an effect, before anything is proved of it.
using Change = std::function<void(lower::Lowered& lowered, size_t pass)>;

/// Nothing, and a report, where a document is too large. `change` may be empty.
std::optional<std::vector<Subject>> subjects_of(const check::TypedGraph& graph,
                                                support::Diagnostics& diagnostics,
                                                functions::Tier tier = functions::Tier::standard,
                                                const Change& change = {});

/// How much is not proved of a subject, by what is reported.
struct NotProved {
  size_t refuted = 0, undecided = 0;
  size_t shown = 0;  ///< of both
  size_t later = 0;  ///< undecided, of Proof::later
};

/// The same without a report; nothing is shown.
NotProved count(const Subject& subject, const Proof& proof);

/// What is assumed of what the document's function takes from outside, and of what a host answers: of each result of its
/// function, or nothing where the body tells.
Given given_of(const check::TypedGraph& graph, const interface::Binding& binding);
std::vector<Given> answer_of(interface::Host host);

/// The effort for each subject of a document: they share the error analysis time of one function.
Effort effort_for(const std::vector<Subject>& subjects);

enum class Detail : uint8_t {
  brief,  ///< for people: the first ones, with a few of their inputs
  all,    ///< for tools
};

/// Reports what is not proved, at the node where it happens: components of one operation once, and so an operation of a
/// function that several nodes call. Refuted operations first.
NotProved report(const check::TypedGraph& graph, const Subject& subject, const Proof& proof,
                 support::Diagnostics& diagnostics, Detail detail = Detail::brief);

}  // namespace isoshade::prove
