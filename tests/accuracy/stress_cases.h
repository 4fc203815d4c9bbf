// SPDX-License-Identifier: Apache-2.0
// The point cases of data/stress_cases.jsonl, and which functions they are cases of.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "backends/reference/real.h"
#include "tests/accuracy/subject.h"

namespace isoshade::accuracy {

struct Case {
  std::string id;                                    ///< "ggx_d-000": its group and number
  std::map<std::string, std::vector<float>> inputs;  ///< by name: components
  std::string inputs_text;                           ///< for people
  std::vector<reference::Real> wanted;               ///< empty where a range is accepted
  std::optional<double> ulp, absolute;               ///< the error accepted; neither: none
  double low = 0, high = 0;                          ///< the range
};

const std::vector<Case>& cases();

/// A form of what a group of cases is about.
struct Form {
  std::string group;
  Subject subject;
  /// Its inputs in order: names of the case's inputs. "R*3": as three alike, "=1*3": three ones.
  std::vector<std::string> feeds;
  size_t result = 0;  ///< the word of its results that the case is about, or the first of them
};

const std::vector<Form>& library_forms();
const std::vector<Form>& source_forms();

/// How a form does in a case.
struct Outcome {
  const Case* made;
  std::vector<float> results;
  double error =
      0;  ///< in what the case accepts, if that is ULP or absolute; infinite for NaN and infinities
  bool accepted = false;
};
std::vector<Outcome> outcomes(const Form& form);

}  // namespace isoshade::accuracy
