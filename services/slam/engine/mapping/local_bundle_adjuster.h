// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "map/slam_map.h"
#include "optimization/map_bundle.h"

namespace kinemap {

struct LocalBundleOptions {
  int keyframes = 15;   ///< that move: the newest and those that share most landmarks with it
  int min_shared = 15;  ///< landmarks a keyframe must share with the newest to take part
  BundleOptions solver;
};

/// Chooses what a new keyframe's bundle adjustment is about. Landmarks that stay out of tracking take no part.
class LocalBundleAdjuster {
 public:
  explicit LocalBundleAdjuster(const LocalBundleOptions& options) : options_(options) {}

  /// Moving: the keyframe and its neighbours. Fixed: the first keyframe and all others that see the same landmarks.
  BundleProblem CopyProblem(const SlamMap& map, KeyframeId keyframe_id) const;

 private:
  LocalBundleOptions options_;
};

}  // namespace kinemap
