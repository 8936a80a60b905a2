// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "map/ids.h"
#include "semi_dense/pixel_labels.h"

namespace kinemap {

/// Inverse depths, in the units of the keyframe's anchored points, between which the scene lies.
struct DepthRange {
  float farthest = 0;  ///< the smaller inverse depth
  float nearest = 0;

  bool IsKnown() const { return nearest > farthest; }
};

/// A keyframe's image with all that a search in it needs, in undistorted pixels.
struct KeyframeView {
  KeyframeId id = kNoId;
  int64_t timestamp_ns = 0;
  cv::Mat grey;      ///< CV_8U
  cv::Mat gradient;  ///< CV_16SC2, x and y, kGradientUnit for one grey level a pixel
  PixelLabels labels;
  DepthRange range;

  /// What a 3x3 Sobel filter answers to a slope of one grey level a pixel.
  static constexpr int kGradientUnit = 8;
};

}  // namespace kinemap
