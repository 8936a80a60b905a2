// SPDX-License-Identifier: Apache-2.0
#include "semi_dense/intra_keyframe_check.h"

#include <algorithm>
#include <cmath>

namespace kinemap {
namespace {

constexpr int kLeastSupport = 2;

struct Neighborhood {
  InverseDepth around[8];
  int count = 0;

  Neighborhood(const KeyframeView& view, const InverseDepthImage& estimates, const cv::Point& pixel) {
    const uint8_t label = view.labels.IndexAt(pixel.x, pixel.y);
    for (int row = pixel.y - 1; row <= pixel.y + 1; ++row) {
      for (int column = pixel.x - 1; column <= pixel.x + 1; ++column) {
        const InverseDepth& estimate = estimates.At(column, row);
        if ((column == pixel.x && row == pixel.y) || !estimate.IsKnown()) continue;
        if (view.labels.IndexAt(column, row) == label) around[count++] = estimate;
      }
    }
  }

  /// Mean over those that agree with `center`, itself included; unknown with too few others.
  InverseDepth MeanAround(const InverseDepth& center) const {
    InverseDepthMean mean;
    mean.Add(center);
    int support = 0;
    float least_sigma = center.sigma;
    for (int i = 0; i < count; ++i) {
      if (!AreCompatible(center, around[i])) continue;
      mean.Add(around[i]);
      least_sigma = std::min(least_sigma, around[i].sigma);
      ++support;
    }
    // Neighbours share their images' noise, so that their mean is no more certain than the best of them.
    return support >= kLeastSupport ? InverseDepth{mean.value(), least_sigma} : InverseDepth{};
  }

  /// What the largest set of them that agrees says; unknown with too few.
  InverseDepth MeanOfMost() const {
    const InverseDepth* center = nullptr;
    int most = kLeastSupport - 1;
    for (int i = 0; i < count; ++i) {
      int agreeing = 0;
      for (int j = 0; j < count; ++j) agreeing += AreCompatible(around[i], around[j]) ? 1 : 0;
      if (agreeing <= most) continue;
      most = agreeing;
      center = &around[i];
    }
    if (center == nullptr) return {};
    InverseDepthMean mean;
    float largest_sigma = 0;
    for (int i = 0; i < count; ++i) {
      if (!AreCompatible(*center, around[i])) continue;
      mean.Add(around[i]);
      largest_sigma = std::max(largest_sigma, around[i].sigma);
    }
    return {mean.value(), largest_sigma};
  }
};

}  // namespace

void CheckAgainstNeighbors(const KeyframeView& view, const std::vector<cv::Point>& pixels,
                           InverseDepthImage* estimates) {
  const InverseDepthImage before = *estimates;
  for (const cv::Point& pixel : pixels) {
    const Neighborhood neighbors(view, before, pixel);
    const InverseDepth& own = before.At(pixel.x, pixel.y);
    estimates->At(pixel.x, pixel.y) = own.IsKnown() ? neighbors.MeanAround(own) : neighbors.MeanOfMost();
  }
}

}  // namespace kinemap
