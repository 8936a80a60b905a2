// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "features/object_labels.h"

namespace kinemap {

/// How many features to ask of the next image. Features are extracted before its masks are known, so the last frame
/// tells how many will lie on objects that stay out of tracking: in dense traffic that is most of them, and what is
/// left is too little to follow the camera by.
class FeatureBudget {
 public:
  explicit FeatureBudget(int wanted) : wanted_(wanted), next_(wanted) {}

  /// Between `wanted` and twice as many.
  int next() const { return next_; }
  void Restore(int next) { next_ = next; }

  /// Takes in the labels of the newest frame's features.
  void Observe(const std::vector<FeatureLabel>& labels);

 private:
  int wanted_, next_;
};

}  // namespace kinemap
