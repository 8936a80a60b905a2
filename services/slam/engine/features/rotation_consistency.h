// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

namespace kinemap {

/// Between two images of one scene nearly all keypoints turn by the same angle; matches that turn by another are wrong.
class RotationConsistency {
 public:
  /// Adds match number `match`, whose keypoint turned by the difference of these angles.
  void Add(int match, float from_angle_deg, float to_angle_deg);

  /// Matches outside the three fullest bins of 12 degrees.
  std::vector<int> Inconsistent() const;

 private:
  static constexpr int kBins = 30;
  std::array<std::vector<int>, kBins> bins_;
};

}  // namespace kinemap
