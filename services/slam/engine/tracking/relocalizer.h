// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "geometry/camera_model.h"
#include "map/frame.h"
#include "map/slam_map.h"
#include "tracking/frame_pose_solver.h"

namespace kinemap {

/// Finds a lost camera again: matches the frame by descriptor with the keyframes nearest to where it was last seen and,
/// a few more each time, with all the others in turn; then PnP (RANSAC) and pose optimisation.
class Relocalizer {
 public:
  explicit Relocalizer(const CameraModel& camera) : camera_(camera), solver_(camera) {}

  /// True when the frame now has a pose and matches. `lost_frames` counts the attempts since tracking was lost.
  bool Relocalize(const SlamMap& map, const Eigen::Vector3d& last_center_in_map, int lost_frames, Frame* frame) const;

 private:
  std::vector<KeyframeId> Candidates(const SlamMap& map, const Eigen::Vector3d& last_center_in_map,
                                     int lost_frames) const;
  bool TryKeyframe(const SlamMap& map, KeyframeId keyframe_id, Frame* frame) const;
  bool SolvePnp(const SlamMap& map, Frame* frame) const;

  CameraModel camera_;
  FramePoseSolver solver_;
};

}  // namespace kinemap
