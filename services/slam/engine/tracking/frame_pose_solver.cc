// SPDX-License-Identifier: Apache-2.0
#include "tracking/frame_pose_solver.h"

#include "map/reprojection_check.h"

namespace kinemap {

PoseEstimate FramePoseSolver::Solve(const SlamMap& map, Frame* frame, const std::optional<PosePrior>& prior) const {
  std::vector<PoseObservation> observations;
  std::vector<int> keypoints;
  for (int i = 0; i < frame->size(); ++i) {
    if (frame->landmark_ids[i] == kNoId) continue;
    const Landmark* landmark = map.FindLandmark(frame->landmark_ids[i]);
    if (landmark == nullptr || !landmark->IsTrackable()) {
      frame->landmark_ids[i] = kNoId;
      continue;
    }
    const Keypoint& keypoint = frame->features->keypoints[i];
    observations.push_back({map.PositionInMap(*landmark), keypoint.pixel_px, keypoint.InverseVariance(map.scales()),
                            RightXIn(map, keypoint)});
    keypoints.push_back(i);
  }
  PoseEstimate estimate = optimizer_.Optimize(frame->camera_from_map, observations, prior);
  frame->camera_from_map = estimate.camera_from_map;
  for (size_t i = 0; i < keypoints.size(); ++i) {
    if (!estimate.inlier[i]) frame->landmark_ids[keypoints[i]] = kNoId;
  }
  return estimate;
}

}  // namespace kinemap
