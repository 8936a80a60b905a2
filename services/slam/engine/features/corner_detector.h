// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "features/corner.h"

namespace kinemap {

struct CornerThresholds {
  int strong = 20;  ///< grey levels a corner must differ from its circle by more than
  int faint = 7;    ///< in cells of the image that hold no strong corner
};

/// FAST corners of an 8-bit image at the local maxima of their score, in one pass: every pixel gets its score, so the
/// second threshold costs nothing. Buffers are kept between calls; not to be used by two threads at once.
class CornerDetector {
 public:
  explicit CornerDetector(const CornerThresholds& thresholds) : thresholds_(thresholds) {}

  /// Row by row, at least `border_px` (4 or more) from each edge.
  const std::vector<Corner>& Detect(const cv::Mat& image, int border_px);

 private:
  void FindMaxima(const cv::Mat& image, int border_px);
  void KeepStrongOrAlone(const cv::Size& size, int border_px);

  CornerThresholds thresholds_;
  std::vector<uint8_t> scores_;  // of three rows
  std::vector<uint8_t> is_maximum_;
  std::vector<uint8_t> cell_has_strong_;
  std::vector<Corner> corners_;
};

}  // namespace kinemap
