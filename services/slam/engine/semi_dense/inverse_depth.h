// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace kinemap {

/// A Gaussian over the inverse of a depth along the optical axis, in the units of the keyframe's anchored points.
struct InverseDepth {
  float value = 0;
  float sigma = 0;  ///< 0: unknown

  bool IsKnown() const { return sigma > 0; }
  float Weight() const { return 1 / (sigma * sigma); }
};

/// Whether two estimates may be of one point: 95 % of chi-squared with two degrees of freedom (Mur-Artal and Tardos
/// 2015, eq. 14).
inline bool AreCompatible(const InverseDepth& a, const InverseDepth& b) {
  const float difference = a.value - b.value;
  const float squared = difference * difference;
  return squared * a.Weight() + squared * b.Weight() < 5.99f;
}

/// The weighted mean of estimates that are added one by one.
class InverseDepthMean {
 public:
  void Add(const InverseDepth& estimate) {
    const float weight = estimate.Weight();
    weighted_ += weight * estimate.value;
    weight_ += weight;
  }
  float value() const { return weighted_ / weight_; }
  float weight() const { return weight_; }

 private:
  float weighted_ = 0, weight_ = 0;
};

/// One estimate a pixel, row by row.
class InverseDepthImage {
 public:
  InverseDepthImage() = default;
  InverseDepthImage(int width, int height) : width_(width), height_(height), pixels_(width * height) {}

  bool empty() const { return pixels_.empty(); }
  int width() const { return width_; }
  int height() const { return height_; }
  InverseDepth& At(int column, int row) { return pixels_[row * width_ + column]; }
  const InverseDepth& At(int column, int row) const { return pixels_[row * width_ + column]; }

 private:
  int width_ = 0, height_ = 0;
  std::vector<InverseDepth> pixels_;
};

}  // namespace kinemap
