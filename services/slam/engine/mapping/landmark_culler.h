// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "map/slam_map.h"

namespace kinemap {

/// Puts every new landmark on trial for its first keyframes: it must be found in a quarter of the frames that should
/// see it and be observed in three images (Mur-Artal, Montiel and Tardos 2015, section VI-B).
class LandmarkCuller {
 public:
  /// Landmarks and how many keyframes came after them. Ids do not tell that: merged maps have several blocks of them.
  using OnTrial = std::map<LandmarkId, int>;

  void Add(const std::vector<LandmarkId>& landmarks);

  const OnTrial& on_trial() const { return on_trial_; }
  /// Others take the places of the landmarks on trial, which stay, untried.
  void Replace(OnTrial on_trial) { on_trial_ = std::move(on_trial); }

  /// Removes what failed; once a keyframe, just inserted.
  void Cull(SlamMap* map);

 private:
  OnTrial on_trial_;
};

}  // namespace kinemap
