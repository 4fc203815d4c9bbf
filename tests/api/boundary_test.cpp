// SPDX-License-Identifier: Apache-2.0
// What goes wrong inside is an outcome outside.
#include "compiler/api/boundary.h"

#include <cfenv>
#include <gtest/gtest.h>
#include <new>
#include <string>
#include <tbb/parallel_for.h>

#include "compiler/support/assert.h"

namespace isoshade {
namespace {

struct Result : Outcome {
  std::string value;
};

TEST(Boundary, AnInternalErrorIsAnOutcome) {
  const auto result = api::guarded<Result>({}, [](Result& half, support::Diagnostics&) {
    half.value = "half";
    support::bug("two and two are five");
    return true;
  });
  EXPECT_EQ(result.status, Status::internal_error);
  EXPECT_EQ(result.value, "") << "a result without success is empty";
  ASSERT_EQ(result.diagnostics.size(), 1u);
  EXPECT_EQ(result.diagnostics[0].id, "internal-error");
  EXPECT_EQ(result.diagnostics[0].message, "two and two are five");
  EXPECT_EQ(result.text, "error[internal-error]: two and two are five\n");
}

TEST(Boundary, AnInternalErrorOfAnotherThreadIsAnOutcome) {
  const auto result = api::guarded<Result>({}, [](Result&, support::Diagnostics&) {
    tbb::parallel_for(0, 100, [](int i) { support::assert_that(i != 50, "fifty"); });
    return true;
  });
  EXPECT_EQ(result.status, Status::internal_error);
  EXPECT_EQ(result.diagnostics.at(0).message, "fifty");
}

TEST(Boundary, LackOfMemoryIsAnOutcome) {
  const auto result = api::guarded<Result>({}, [](Result&, support::Diagnostics&) -> bool { throw std::bad_alloc(); });
  EXPECT_EQ(result.status, Status::out_of_memory);
  EXPECT_EQ(result.diagnostics.at(0).id, "device-limit");
}

TEST(Boundary, AFailureWithoutADiagnosticIsAnInternalError) {
  const auto result = api::guarded<Result>({}, [](Result&, support::Diagnostics&) { return false; });
  EXPECT_EQ(result.status, Status::internal_error);
  EXPECT_EQ(result.diagnostics.size(), 1u);
}

TEST(Boundary, AWarningAsErrorFails) {
  Sources sources;
  const auto warn = [](Result&, support::Diagnostics& diagnostics) {
    diagnostics.report(support::Id::unused_node, "no output depends on it");
    return true;
  };
  EXPECT_TRUE(api::guarded<Result>(sources, warn));
  EXPECT_EQ(api::guarded<Result>(sources, warn).diagnostics.at(0).severity, Severity::warning);
  sources.warnings_as_errors = true;
  EXPECT_EQ(api::guarded<Result>(sources, warn).status, Status::failed);
  sources.disabled_warnings = {"unused-node"};
  EXPECT_TRUE(api::guarded<Result>(sources, warn).diagnostics.empty());
}

TEST(Boundary, TheFloatModeOfTheCallerComesBack) {
  ASSERT_EQ(std::fesetround(FE_UPWARD), 0);
  int inside = -1;
  api::guarded<Result>({}, [&](Result&, support::Diagnostics&) {
    inside = std::fegetround();
    return true;
  });
  const int outside = std::fegetround();
  std::fesetround(FE_TONEAREST);
  EXPECT_EQ(inside, FE_TONEAREST);
  EXPECT_EQ(outside, FE_UPWARD);
}

}  // namespace
}  // namespace isoshade
