// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace kinemap {

/// Scale of each pyramid level: level l is the image shrunk by factor^l, so one of its pixels is that many of the
/// image's, and so is the standard deviation of a keypoint found there.
class PyramidScales {
 public:
  PyramidScales(int levels, double factor) : log_factor_(std::log(factor)) {
    double scale = 1;
    for (int level = 0; level < levels; ++level, scale *= factor) scales_.push_back(scale);
  }

  int levels() const { return static_cast<int>(scales_.size()); }
  double scale(int level) const { return scales_[level]; }
  double inverse_variance(int level) const { return 1.0 / (scales_[level] * scales_[level]); }

  /// Level at which a point of this scale ratio (largest distance it can be seen from / current distance) appears.
  int LevelOf(double ratio) const {
    const int level = static_cast<int>(std::ceil(std::log(std::max(ratio, 1e-9)) / log_factor_ - 1e-9));
    return std::clamp(level, 0, levels() - 1);
  }

 private:
  double log_factor_;
  std::vector<double> scales_;
};

}  // namespace kinemap
