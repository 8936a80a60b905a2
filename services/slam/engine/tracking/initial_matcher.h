// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "features/brute_force_matcher.h"
#include "map/frame.h"

namespace kinemap {

/// Follows the trackable keypoints of a reference frame through the frames after it, each in a window around where it
/// was last seen.
class InitialMatcher {
 public:
  explicit InitialMatcher(const Frame& reference);

  /// Matches (query: reference's keypoint, train: current's keypoint), mutually best, all turning alike.
  std::vector<FeatureMatch> Match(const Frame& reference, const Frame& current);

  /// Where the reference's keypoints were last seen, one each.
  const std::vector<Eigen::Vector2d>& last_seen_px() const { return last_seen_px_; }
  void Restore(std::vector<Eigen::Vector2d> last_seen_px) { last_seen_px_ = std::move(last_seen_px); }

 private:
  std::vector<Eigen::Vector2d> last_seen_px_;  // one a keypoint of the reference
};

}  // namespace kinemap
