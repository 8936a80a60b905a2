// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace kinemap {

/// One binary test of a patch: whether the pixel at a is darker than the one at b, from the keypoint, unrotated.
struct BriefTest {
  int a_column, a_row, b_column, b_row;
};

/// The 256 tests of ORB, learned to be uncorrelated (Rublee et al. 2011, section 4.3). OpenCV keeps its table to
/// itself, so it is read off the descriptors that OpenCV gives to images of a single edge; takes some milliseconds,
/// once a process.
const std::array<BriefTest, 256>& LearnedBriefTests();

}  // namespace kinemap
