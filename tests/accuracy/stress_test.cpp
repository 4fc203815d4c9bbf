// SPDX-License-Identifier: Apache-2.0
// Inputs at which formulas break: the library's forms keep what is accepted at all of them, on every backend, and what
// becomes of the forms that they replace is told in docs/stress.md. `stress_test --update` writes that page.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <gtest/gtest.h>
#include <set>
#include <sstream>

#include "compiler/support/parse_number.h"
#include "tests/accuracy/stress_cases.h"
#include "tests/accuracy/stress_comparison.h"

namespace isoshade::accuracy {
namespace {

bool update = false;

std::string listed(const std::vector<float>& values, size_t count) {
  std::string text;
  for (size_t i = 0; i < count; ++i) text += (text.empty() ? "" : " ") + support::format_float(values[i]);
  return text;
}

std::string given(const Outcome& outcome) {
  return listed(outcome.results, std::max<size_t>(1, outcome.made->wanted.size()));
}

std::string wanted(const Case& made) {
  if (made.wanted.empty())
    return made.high > 1e38 ? "a finite number"
                            : "within " + support::format_float(static_cast<float>(made.low)) + " and " +
                                  support::format_float(static_cast<float>(made.high));
  std::string text;
  for (const reference::Real& value : made.wanted) text += (text.empty() ? "" : " ") + value.text(9);
  return text;
}

std::string short_number(double x) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.3g", x);
  return buffer;
}

std::string error(const Outcome& outcome) {
  const Case& made = *outcome.made;
  if (std::isinf(outcome.error)) return "not finite";
  if (made.wanted.empty()) return "out of range";
  return short_number(outcome.error) + (made.ulp ? " ULP" : "");
}

std::string acceptance(const Case& made) {
  if (made.ulp) return short_number(*made.ulp) + " ULP";
  if (made.absolute) return short_number(*made.absolute);
  return made.wanted.empty() ? "" : "0";
}

TEST(Stress, EveryCaseHasAForm) {
  std::set<std::string> groups;
  for (const Form& form : library_forms()) groups.insert(form.group);
  EXPECT_EQ(cases().size(), 292u);
  for (const Case& made : cases())
    EXPECT_TRUE(groups.contains(made.id.substr(0, made.id.rfind('-')))) << made.id;
}

/// A form by the bodies of another tier.
Form in_tier(const Form& form, functions::Tier tier) {
  return {form.group, form.subject.in_tier(tier), form.feeds, form.result};
}

void expect_accepted(const std::vector<Form>& forms, functions::Tier tier) {
  for (const Form& form : forms) {
    for (const Outcome& outcome : outcomes(in_tier(form, tier)))
      EXPECT_TRUE(outcome.accepted) << outcome.made->id << ", " << form.subject.name() << " at "
                                    << outcome.made->inputs_text << ": " << given(outcome) << ", not "
                                    << wanted(*outcome.made) << "; off by " << error(outcome) << ", accepted "
                                    << acceptance(*outcome.made);
  }
}

TEST(Stress, LibraryFormsPassEveryCase) { expect_accepted(library_forms(), functions::Tier::standard); }
TEST(Stress, LibraryFormsPassEveryCaseInThePreciseTier) {
  expect_accepted(library_forms(), functions::Tier::precise);
}

/// Of those that err the most, measured in what is accepted.
const Outcome* worst_of(const std::vector<Outcome>& all, bool failed) {
  const auto share = [](const Outcome& outcome) {
    const double accepted = outcome.made->ulp.value_or(outcome.made->absolute.value_or(0));
    return accepted == 0 ? outcome.error : outcome.error / accepted;
  };
  const Outcome* worst = nullptr;
  for (const Outcome& outcome : all)
    if (outcome.accepted != failed && (worst == nullptr || share(outcome) > share(*worst))) worst = &outcome;
  return worst;
}

std::string page_text() {
  std::string text =
      "<!-- Made by `stress_test --update` from tests/accuracy/data/stress_cases.jsonl. -->\n"
      "# Where textbook formulas fail\n\n"
      "Inputs at which textbook formulas lose digits or divide by zero: highlights of smooth surfaces, grazing\n"
      "light, fog far from the origin, distances near the far plane. The exact results were computed in 70 digits\n"
      "([tests/accuracy/data](../tests/accuracy/data/README.md)). Errors are the same on every backend, bit for "
      "bit.\n\n"
      "## Formulas of the library\n\n"
      "For each tier, the error that is the largest share of the accepted error. `default` and `precise` are within\n"
      "the accepted error in every case.\n\n"
      "| cases | formula | default | precise | fast | accepted error |\n|---|---|---|---|---|---|\n";
  for (const Form& form : library_forms()) {
    const std::string count = std::to_string(outcomes(form).size());
    text += "| " + count + " of `" + form.group + "` | `" + form.subject.name() + "` |";
    std::string accepted;
    for (const functions::Tier tier :
         {functions::Tier::standard, functions::Tier::precise, functions::Tier::fast}) {
      const std::vector<Outcome> all = outcomes(in_tier(form, tier));
      const auto failed = std::ranges::count(all, false, &Outcome::accepted);
      const Outcome* worst = worst_of(all, failed != 0);
      const bool measured = worst != nullptr && !acceptance(*worst->made).empty();
      text += " " + (measured ? error(*worst) : "");
      if (failed != 0) text += " (" + std::to_string(failed) + " fail)";
      text += " |";
      if (tier == functions::Tier::standard && measured) accepted = acceptance(*worst->made);
    }
    text += " " + accepted + " |\n";
  }
  text +=
      "\n## Formulas of the sources\n\n"
      "| formula | failing cases | worst case | result | exact result | error | accepted error |\n|---|---|---|---|---|---|---|\n";
  for (const Form& form : source_forms()) {
    const std::vector<Outcome> all = outcomes(form);
    size_t failed = 0;
    for (const Outcome& outcome : all) failed += outcome.accepted ? 0 : 1;
    text += "| `" + form.subject.name() + "` | " + std::to_string(failed) + " of " +
            std::to_string(all.size()) + " | ";
    if (const Outcome* worst = worst_of(all, true))
      text += "`" + worst->made->id + "`: " + worst->made->inputs_text + " | " + given(*worst) + " | " +
              wanted(*worst->made) + " | " + error(*worst) + " | " + acceptance(*worst->made) + " |\n";
    else
      text += "| | | | |\n";
  }
  text += "\n## Properties\n\n| | library | source |\n|---|---|---|\n";
  for (const Comparison& row : comparisons())
    text += "| " + row.what + " | " + row.library + " | " + row.source + " |\n";
  return text;
}

TEST(Stress, PageIsUpToDate) {
  std::ifstream file(ISOSHADE_STRESS_PAGE);
  const std::string page = (std::stringstream() << file.rdbuf()).str();
  EXPECT_TRUE(update || page == page_text()) << "run stress_test --update";
}

}  // namespace
}  // namespace isoshade::accuracy

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  isoshade::accuracy::update = argc > 1 && std::string(argv[1]) == "--update";
  if (isoshade::accuracy::update)
    std::ofstream(ISOSHADE_STRESS_PAGE, std::ios::binary) << isoshade::accuracy::page_text();
  return RUN_ALL_TESTS();
}
