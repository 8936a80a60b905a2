// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <utility>

#include "map/slam_map.h"

namespace kinemap {

/// Metres for a map that began without: a depth camera that reaches less far than the first landmarks lie measures some
/// of them later. From thirty measured landmarks on the map's scale is known.
class LateMetricScale {
 public:
  /// Compares the landmarks of a keyframe with the depths measured in it.
  void Look(const SlamMap& map, KeyframeId keyframe_id);

  bool IsFound() const;

  /// Makes the map metric: every keyframe becomes the Sim(3) that it is in metres, about the first one, which stays
  /// where it is. Returns the metres of one of the map's former units. Nothing may be in the background.
  double Apply(SlamMap* map);

  /// What was compared so far, in which map.
  struct State {
    int64_t map_id = -1;
    std::map<LandmarkId, double> metres_per_unit;
  };
  const State& state() const { return state_; }
  void Restore(State state) { state_ = std::move(state); }

 private:
  State state_;
};

}  // namespace kinemap
