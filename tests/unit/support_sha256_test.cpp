// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "compiler/support/sha256.h"

namespace isoshade::support {
namespace {

// FIPS 180-4 example values.
constexpr std::string_view of_nothing = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
constexpr std::string_view of_abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";

TEST(Sha256, MatchesPublishedTestVectors) {
  EXPECT_EQ(sha256(""), of_nothing);
  EXPECT_EQ(sha256("abc"), of_abc);
  EXPECT_EQ(sha256(std::string(1'000'000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, HashOfPartsEqualsHashOfTheWhole) {
  Sha256 hash;
  EXPECT_EQ(hash.hex(), of_nothing);
  hash.add("a").add("");
  EXPECT_EQ(hash.hex(), sha256("a"));
  const char rest[] = {'b', 'c'};
  hash.add(rest, sizeof rest);
  EXPECT_EQ(hash.hex(), of_abc);
  EXPECT_EQ(hash.hex(), of_abc);  // asking changes nothing
}

}  // namespace
}  // namespace isoshade::support
