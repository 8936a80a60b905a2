// SPDX-License-Identifier: Apache-2.0
#include "ground/contact_placer.h"

namespace kinemap {

int ContactPlacer::Place(SlamMap* map, KeyframeId keyframe_id, const Frame& frame,
                         const ObjectContacts& contacts) const {
  const RigidTransform map_from_camera = frame.camera_from_map.Inverse();
  int placed = 0;
  for (int i = 0; i < frame.size(); ++i) {
    if (frame.labels[i].role != FeatureRole::kSighted) continue;
    const Keypoint& keypoint = frame.features->keypoints[i];
    const std::optional<double> depth = contacts.Depth(frame.labels[i].object_id, keypoint.raw_px.x());
    if (!depth) continue;
    map->CreateLandmark(map_from_camera * (*depth * camera_.Ray(keypoint.pixel_px)), keyframe_id, frame.labels[i]);
    ++placed;
  }
  return placed;
}

}  // namespace kinemap
