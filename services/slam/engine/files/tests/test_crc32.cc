// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>

#include "files/crc32.h"

namespace kinemap {
namespace {

TEST(Crc32, IsTheOneOfZlib) {
  const std::string digits = "123456789";
  EXPECT_EQ(Crc32(digits.data(), digits.size()), 0xCBF43926u);
  EXPECT_EQ(Crc32(nullptr, 0), 0u);
}

}  // namespace
}  // namespace kinemap
