// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "features/descriptor.h"

namespace kinemap {

/// Pixels around a keypoint that the tests, however turned, look at.
constexpr int kBriefReachPx = 19;

/// ORB's descriptor (Rublee et al. 2011, section 4): 256 tests of the smoothed patch, turned by the keypoint's angle in
/// steps of three degrees.
class SteeredBrief {
 public:
  SteeredBrief();

  /// `smoothed` is 8-bit, blurred by a Gaussian of 2 pixels; the pixel at least kBriefReachPx from its edges.
  Descriptor Compute(const cv::Mat& smoothed, int column, int row, float angle_deg) const;

 private:
  struct Place {
    int8_t column, row;
  };
  std::vector<Place> places_;  // by angle, test, and a before b
};

}  // namespace kinemap
