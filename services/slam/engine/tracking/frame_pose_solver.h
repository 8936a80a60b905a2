// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "map/frame.h"
#include "map/slam_map.h"
#include "optimization/pose_optimizer.h"

namespace kinemap {

/// Optimises a frame's pose from its matches and drops the matches that do not fit.
class FramePoseSolver {
 public:
  explicit FramePoseSolver(const CameraModel& camera) : optimizer_(camera) {}

  PoseEstimate Solve(const SlamMap& map, Frame* frame) const;

 private:
  PoseOptimizer optimizer_;
};

}  // namespace kinemap
