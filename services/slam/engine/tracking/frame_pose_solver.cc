// SPDX-License-Identifier: Apache-2.0
#include "tracking/frame_pose_solver.h"

#include "map/depth_error.h"
#include "map/reprojection_check.h"

namespace kinemap {
namespace {
constexpr double kViewErrorPx = 2;  // of a keypoint, and of where the camera stood that saw it
}  // namespace

PoseEstimate FramePoseSolver::Solve(const SlamMap& map, Frame* frame, const std::optional<PosePrior>& prior) const {
  std::vector<PoseObservation> observations;
  std::vector<int> keypoints;
  const Eigen::Vector3d center = frame->camera_from_map.Inverse().translation;
  for (int i = 0; i < frame->size(); ++i) {
    if (frame->landmark_ids[i] == kNoId) continue;
    const Landmark* landmark = map.FindLandmark(frame->landmark_ids[i]);
    if (landmark == nullptr || !landmark->IsTrackable()) {
      frame->landmark_ids[i] = kNoId;
      continue;
    }
    const Keypoint& keypoint = frame->features->keypoints[i];
    observations.push_back({map.PositionInMap(*landmark), keypoint.pixel_px, keypoint.InverseVariance(map.scales()),
                            RightXIn(map, keypoint),
                            DepthError(map, *landmark, center, kViewErrorPx / camera_.fx_px())});
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
