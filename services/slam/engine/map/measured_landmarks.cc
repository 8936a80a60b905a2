// SPDX-License-Identifier: Apache-2.0
#include "map/measured_landmarks.h"

namespace kinemap {

std::vector<LandmarkId> CreateMeasuredLandmarks(const CameraModel& camera, KeyframeId keyframe_id,
                                                const std::vector<int>& keypoints, SlamMap* map) {
  const Keyframe& keyframe = map->keyframe(keyframe_id);
  std::vector<LandmarkId> made;
  for (const int i : keypoints) {
    const Keypoint& keypoint = keyframe.features->keypoints[i];
    const Eigen::Vector3d in_camera = keypoint.depth_m * camera.Ray(keypoint.pixel_px);
    Landmark& landmark = map->CreateLandmark(keyframe.map_from_keyframe * in_camera, keyframe_id, keyframe.labels[i]);
    map->Observe(&landmark, keyframe_id, i);
    map->UpdateDescriptor(&landmark);
    map->UpdateViewRange(&landmark);
    made.push_back(landmark.id);
  }
  return made;
}

}  // namespace kinemap
