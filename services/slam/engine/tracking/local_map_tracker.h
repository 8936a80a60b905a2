// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "geometry/camera_model.h"
#include "map/frame.h"
#include "map/id_set.h"
#include "map/slam_map.h"
#include "tracking/frame_pose_solver.h"

namespace kinemap {

/// Refines a frame whose pose is roughly known against all landmarks of the keyframes around it.
class LocalMapTracker {
 public:
  explicit LocalMapTracker(const CameraModel& camera) : camera_(camera), solver_(camera) {}

  /// Chooses the local map by the frame's matches, finds more matches in it and optimises the pose. Sets the frame's
  /// reference keyframe (the one that shares most landmarks with it) and counts in each landmark whether it was found.
  /// With `radius_factor` > 1 the search is wider (after a relocalisation). `prior`: where the camera was expected. A
  /// pose that chance explains keeps no match and has no inliers.
  PoseEstimate Track(SlamMap* map, double radius_factor, Frame* frame,
                     const std::optional<PosePrior>& prior = std::nullopt) const;

 private:
  std::vector<KeyframeId> LocalKeyframes(const SlamMap& map, const Frame& frame) const;
  /// Landmarks of the local map by what became of them; each set holds the next.
  struct Searched {
    IdSet in_view;
    IdSet looked_for;  ///< something that may be them lies where they should be
  };
  void SearchLocalLandmarks(SlamMap* map, const std::vector<KeyframeId>& keyframes, double radius_factor,
                            Searched* searched, Frame* frame) const;
  bool IsFoundByChance(const SlamMap& map, const Searched& searched, const Frame& frame) const;

  CameraModel camera_;
  FramePoseSolver solver_;
};

}  // namespace kinemap
