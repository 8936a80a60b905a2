// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>

#include "geometry/camera_model.h"
#include "map/slam_map.h"
#include "optimization/bundle_adjustment.h"

namespace kinemap {

struct LocalBundleOptions {
  int keyframes = 15;   ///< that move: the newest and those that share most landmarks with it
  int min_shared = 15;  ///< landmarks a keyframe must share with the newest to take part
  BundleOptions solver;
};

/// Copies the surroundings of a keyframe out of the map to be solved, and writes the solution back. Landmarks that stay
/// out of tracking take no part; they move with their anchor keyframe.
class LocalBundleAdjuster {
 public:
  explicit LocalBundleAdjuster(const LocalBundleOptions& options) : options_(options) {}

  /// Moving: the keyframe and its neighbours. Fixed: the first keyframe and all others that see the same landmarks.
  BundleProblem CopyProblem(const SlamMap& map, KeyframeId keyframe_id) const;

  /// The same with the moving keyframes given.
  static BundleProblem CopyProblem(const SlamMap& map, const std::set<KeyframeId>& moving);

  /// Moves keyframes and landmarks that still exist and erases the observations marked as outliers.
  static void WriteBack(const BundleProblem& solved, SlamMap* map);

 private:
  LocalBundleOptions options_;
};

}  // namespace kinemap
