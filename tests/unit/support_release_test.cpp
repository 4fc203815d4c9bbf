// SPDX-License-Identifier: Apache-2.0
#include "compiler/support/memory.h"

#include <gtest/gtest.h>

namespace isoshade {
namespace {

TEST(Release, LeavesNoCapacity) {
  std::vector<float> vector(1000);
  support::release(vector);
  EXPECT_EQ(vector.capacity(), 0u);
}

}  // namespace
}  // namespace isoshade
