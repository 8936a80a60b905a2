// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tracking/lost_policy.h"

namespace kinemap {
namespace {

int FramesUntilItGivesUp(LostPolicy policy, int keyframes) {
  int frames = 0;
  while (!policy.GivesUp(keyframes)) {
    policy.Lost();
    ++frames;
  }
  return frames;
}

TEST(LostPolicy, LeavesAYoungMapSooner) {
  const LostPolicy patient({.patience_frames = 50});
  EXPECT_EQ(FramesUntilItGivesUp(patient, 2), 5);
  EXPECT_EQ(FramesUntilItGivesUp(patient, 30), 50);
  EXPECT_EQ(FramesUntilItGivesUp(LostPolicy({.patience_frames = 3}), 2), 3);
}

TEST(LostPolicy, CountsAnewOnceTheCameraIsFound) {
  LostPolicy policy({.patience_frames = 3});
  policy.Lost();
  policy.Lost();
  policy.Found();
  EXPECT_EQ(FramesUntilItGivesUp(policy, 30), 3);
}

}  // namespace
}  // namespace kinemap
