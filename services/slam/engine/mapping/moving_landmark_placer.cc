// SPDX-License-Identifier: Apache-2.0
#include "mapping/moving_landmark_placer.h"

#include "map/depth_scale.h"

namespace kinemap {

int MovingLandmarkPlacer::Place(SlamMap* map, KeyframeId keyframe_id, const Frame& frame,
                                const cv::Mat& depth_m) const {
  const double units_per_metre = MapUnitsPerMetre(*map, frame, depth_m);
  const RigidTransform map_from_camera = frame.camera_from_map.Inverse();
  int unplaced = 0;
  for (int i = 0; i < frame.size(); ++i) {
    if (frame.labels[i].role != FeatureRole::kSighted) continue;
    const Keypoint& keypoint = frame.features->keypoints[i];
    const double depth = units_per_metre > 0 ? DepthAt(depth_m, keypoint) * units_per_metre : 0;
    if (depth <= 0) {
      ++unplaced;
      continue;
    }
    map->CreateLandmark(map_from_camera * (depth * camera_.Ray(keypoint.pixel_px)), keyframe_id, frame.labels[i]);
  }
  return unplaced;
}

}  // namespace kinemap
