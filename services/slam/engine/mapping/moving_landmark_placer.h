// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/camera_model.h"
#include "map/frame.h"
#include "map/slam_map.h"

namespace kinemap {

/// Moving objects cannot be triangulated, so their features are placed by the depth measured in this very frame: one
/// set of landmarks an object and keyframe, each with the time it was seen and no observation that could constrain a
/// pose.
class MovingLandmarkPlacer {
 public:
  explicit MovingLandmarkPlacer(const CameraModel& camera) : camera_(camera) {}

  /// Returns how many moving features could not be placed.
  int Place(SlamMap* map, KeyframeId keyframe_id, const Frame& frame) const;

 private:
  CameraModel camera_;
};

}  // namespace kinemap
