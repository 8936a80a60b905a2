// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "geometry/camera_model.h"
#include "map/frame.h"
#include "map/slam_map.h"
#include "optimization/pose_optimizer.h"

namespace kinemap {

/// Optimises a frame's pose from its matches and drops the matches that do not fit.
class FramePoseSolver {
 public:
  explicit FramePoseSolver(const CameraModel& camera) : camera_(camera), optimizer_(camera) {}

  /// `prior`: where the camera was expected.
  PoseEstimate Solve(const SlamMap& map, Frame* frame, const std::optional<PosePrior>& prior = std::nullopt) const;

 private:
  CameraModel camera_;
  PoseOptimizer optimizer_;
};

}  // namespace kinemap
