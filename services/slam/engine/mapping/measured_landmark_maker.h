// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "geometry/camera_model.h"
#include "map/slam_map.h"

namespace kinemap {

/// Makes landmarks of what a new keyframe sees for the first time and knows the depth of: all close points, and the
/// next ones until there are a hundred. What is farther is triangulated over several views (Mur-Artal and Tardos 2017,
/// section III-A).
class MeasuredLandmarkMaker {
 public:
  explicit MeasuredLandmarkMaker(const CameraModel& camera) : camera_(camera) {}

  /// Ids of the landmarks made; none in a map that is not metric.
  std::vector<LandmarkId> Make(SlamMap* map, KeyframeId keyframe_id) const;

 private:
  CameraModel camera_;
};

}  // namespace kinemap
