// SPDX-License-Identifier: Apache-2.0
#include "mapping/moving_landmark_placer.h"

#include "map/depth_scale.h"

namespace kinemap {

int MovingLandmarkPlacer::Place(SlamMap* map, KeyframeId keyframe_id, const Frame& frame) const {
  const double units_per_metre = map->metric_scale() ? 1 : MapUnitsPerMetre(*map, frame);
  const RigidTransform map_from_camera = frame.camera_from_map.Inverse();
  int unplaced = 0;
  for (int i = 0; i < frame.size(); ++i) {
    if (frame.labels[i].role != FeatureRole::kSighted) continue;
    const Keypoint& keypoint = frame.features->keypoints[i];
    const double depth = keypoint.depth_m * units_per_metre;
    if (depth <= 0) {
      ++unplaced;
      continue;
    }
    map->CreateLandmark(map_from_camera * (depth * camera_.Ray(keypoint.pixel_px)), keyframe_id, frame.labels[i]);
  }
  return unplaced;
}

}  // namespace kinemap
