// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "geometry/camera_model.h"
#include "map/slam_map.h"

namespace kinemap {

/// Makes a metric map of one frame whose depths were measured, by a right image or a depth image.
class SingleFrameMapBuilder {
 public:
  SingleFrameMapBuilder(const CameraModel& camera, const PyramidScales& scales) : camera_(camera), scales_(scales) {}

  /// Whether enough trackable points of the frame are close.
  bool CanBuild(const Frame& frame) const;

  /// A map of one keyframe, which stands at this pose; the frame gets pose, matches and reference keyframe.
  std::unique_ptr<SlamMap> Build(int64_t map_id, const RigidTransform& map_from_first_camera, Frame* frame) const;

 private:
  CameraModel camera_;
  PyramidScales scales_;
};

}  // namespace kinemap
