// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <vector>

#include "geometry/camera_model.h"
#include "map/frame.h"
#include "map/slam_map.h"
#include "tracking/frame_pose_solver.h"

namespace kinemap {

/// Refines a frame whose pose is roughly known against all landmarks of the keyframes around it.
class LocalMapTracker {
 public:
  explicit LocalMapTracker(const CameraModel& camera) : camera_(camera), solver_(camera) {}

  /// Chooses the local map by the frame's matches, finds more matches in it and optimises the pose. Sets the frame's
  /// reference keyframe (the one that shares most landmarks with it) and counts in each landmark whether it was found.
  /// With `radius_factor` > 1 the search is wider (after a relocalisation).
  PoseEstimate Track(SlamMap* map, double radius_factor, Frame* frame) const;

 private:
  std::vector<KeyframeId> LocalKeyframes(const SlamMap& map, const Frame& frame) const;
  void SearchLocalLandmarks(SlamMap* map, const std::vector<KeyframeId>& keyframes, double radius_factor,
                            std::set<LandmarkId>* in_view, Frame* frame) const;

  CameraModel camera_;
  FramePoseSolver solver_;
};

}  // namespace kinemap
