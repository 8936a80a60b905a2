// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "map/slam_map.h"

namespace kinemap {

/// Culls keyframes of whose landmarks 90 % are seen by at least three others at the same or a finer scale (Mur-Artal,
/// Montiel and Tardos 2015, section VI-E).
class KeyframeCuller {
 public:
  /// Looks at the neighbours of `keyframe_id`; never at the first keyframe, which holds the map in place, nor at those
  /// that a recognised place ties. Returns how
  /// many were culled.
  int Cull(SlamMap* map, KeyframeId keyframe_id) const;

 private:
  bool IsRedundant(const SlamMap& map, KeyframeId keyframe_id) const;
};

}  // namespace kinemap
