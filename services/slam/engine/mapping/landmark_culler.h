// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "map/slam_map.h"

namespace kinemap {

/// Puts every new landmark on trial for its first keyframes: it must be found in a quarter of the frames that should
/// see it and be observed in three images (Mur-Artal, Montiel and Tardos 2015, section VI-B).
class LandmarkCuller {
 public:
  void Add(const std::vector<LandmarkId>& landmarks);

  const std::vector<LandmarkId>& on_trial() const { return on_trial_; }
  /// Others take the places of the landmarks on trial, which stay, untried.
  void Replace(std::vector<LandmarkId> on_trial) { on_trial_ = std::move(on_trial); }

  /// Removes what failed, with `newest` the keyframe just inserted.
  void Cull(SlamMap* map, KeyframeId newest);

 private:
  std::vector<LandmarkId> on_trial_;
};

}  // namespace kinemap
