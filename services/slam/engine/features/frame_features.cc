// SPDX-License-Identifier: Apache-2.0
#include "features/frame_features.h"

namespace kinemap {

FrameFeaturesPtr Undistorted(const FrameFeatures& features, const CameraModel& camera) {
  auto moved = std::make_shared<FrameFeatures>(features);
  for (Keypoint& keypoint : moved->keypoints) keypoint.pixel_px = camera.Undistort(keypoint.raw_px);
  moved->grid = KeypointGrid(moved->keypoints, camera.low_corner_px(), camera.high_corner_px());
  return moved;
}

}  // namespace kinemap
