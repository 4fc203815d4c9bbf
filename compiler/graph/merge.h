// SPDX-License-Identifier: Apache-2.0
// Documents made of several texts. Every value keeps the text that it stands in, so that what is reported of it points
// there, and so that paths count from there.
#pragma once

#include "compiler/graph/document.h"

namespace isoshade::graph {

/// A value that stands in `source`, as one that can be put into the document.
Json adopted(Document& document, support::Source source, Json value);

/// `base` changed by `changes`, as JSON Merge Patch (RFC 7386) has it: of two objects the members are merged, null
/// removes a member, and anything else takes the place of what was there. Two rules more: an object that tells its
/// "type" takes the place of the other whole, because the keys of another type would mean nothing in it; and a null that
/// removes nothing is reported, but in "extras". The first source of the result is that of `changes`.
Document merge(Document base, Document changes, support::Diagnostics& diagnostics);

}  // namespace isoshade::graph
