// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>

namespace kinemap {

/// The direction in which a corner's surroundings are brightest: from the pixel to the intensity centroid of the disc
/// of 15 pixels around it (Rublee et al. 2011, section 3.2).
class PatchOrientation {
 public:
  PatchOrientation();

  /// Degrees in [0, 360); `image` is 8-bit and reaches 16 pixels further on all sides.
  float AngleDeg(const cv::Mat& image, int column, int row) const;

 private:
  static constexpr int kRadiusPx = 15;
  static constexpr int kRows = 2 * kRadiusPx + 1;
  static constexpr int kColumns = 32;  // a power of two; the last one weighs nothing
  std::array<int16_t, kRows * kColumns> column_weights_{}, row_weights_{};
};

}  // namespace kinemap
