// SPDX-License-Identifier: Apache-2.0
#include "features/patch_orientation.h"

#include <cstring>

namespace kinemap {

PatchOrientation::PatchOrientation() {
  for (int y = -kRadiusPx; y <= kRadiusPx; ++y) {
    for (int x = -kRadiusPx; x <= kRadiusPx; ++x) {
      if (x * x + y * y > kRadiusPx * (kRadiusPx + 1)) continue;
      const int place = (y + kRadiusPx) * kColumns + x + kRadiusPx;
      column_weights_[place] = static_cast<int16_t>(x);
      row_weights_[place] = static_cast<int16_t>(y);
    }
  }
}

float PatchOrientation::AngleDeg(const cv::Mat& image, int column, int row) const {
  std::array<uint8_t, kRows * kColumns> patch;
  for (int i = 0; i < kRows; ++i) {
    std::memcpy(patch.data() + i * kColumns, image.ptr<uint8_t>(row - kRadiusPx + i) + column - kRadiusPx, kColumns);
  }
  int column_moment = 0, row_moment = 0;
  for (size_t i = 0; i < patch.size(); ++i) {
    const int16_t value = patch[i];
    column_moment += column_weights_[i] * value;
    row_moment += row_weights_[i] * value;
  }
  return cv::fastAtan2(static_cast<float>(row_moment), static_cast<float>(column_moment));
}

}  // namespace kinemap
