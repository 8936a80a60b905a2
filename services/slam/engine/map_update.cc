// SPDX-License-Identifier: Apache-2.0
#include "map_update.h"

namespace kinemap {
namespace {

void AddKeyframe(const SlamMap& map, KeyframeId id, MapUpdate* update) {
  const Keyframe& keyframe = map.keyframe(id);
  const SimilarityTransform map_from_anchor = map.MapFromAnchor(id);
  const PoseArray pose = ToPoseArray(map_from_anchor.WithoutScale());
  update->keyframe_id.push_back(id);
  update->keyframe_timestamp_ns.push_back(keyframe.timestamp_ns);
  update->keyframe_map_id.push_back(map.map_id());
  update->keyframe_pose.push_back(
      {pose[0], pose[1], pose[2], pose[3], pose[4], pose[5], pose[6], map_from_anchor.scale});
  update->keyframe_culled.push_back(keyframe.culled ? 1 : 0);
  update->keyframe_parent_id.push_back(keyframe.parent_id);
}

void AddLandmark(const Landmark& landmark, MapUpdate* update) {
  const Eigen::Vector3f position = landmark.position_in_anchor.cast<float>();
  update->landmark_id.push_back(landmark.id);
  update->landmark_anchor_id.push_back(landmark.anchor_id);
  update->landmark_position.push_back({position.x(), position.y(), position.z()});
  update->landmark_state.push_back(static_cast<uint8_t>(landmark.state));
  update->landmark_category.push_back(landmark.category);
  update->landmark_object_id.push_back(landmark.object_id);
  update->landmark_first_seen_ns.push_back(landmark.first_seen_ns);
  update->landmark_last_seen_ns.push_back(landmark.last_seen_ns);
  update->landmark_valid_until_ns.push_back(landmark.valid_until_ns);
}

}  // namespace

PoseArray ToPoseArray(const RigidTransform& transform) {
  const Eigen::Vector3d& t = transform.translation;
  const Eigen::Quaterniond& q = transform.rotation;
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

void AddSemiDense(const std::vector<SemiDenseCloud>& clouds, MapUpdate* update) {
  for (const SemiDenseCloud& cloud : clouds) {
    update->dense_keyframe_id.push_back(cloud.keyframe_id);
    update->dense_keyframe_points.push_back(static_cast<int32_t>(cloud.points.size()));
    for (const SemiDensePoint& point : cloud.points) {
      update->dense_point_position.push_back(point.position);
      update->dense_point_depth_sigma.push_back(point.depth_sigma);
      update->dense_point_grey.push_back(point.grey);
      update->dense_point_state.push_back(static_cast<uint8_t>(point.state));
      update->dense_point_category.push_back(point.category);
      update->dense_point_object_id.push_back(point.object_id);
    }
  }
}

MapUpdate TakeMapUpdate(const Atlas& atlas, const std::vector<LateFramePose>& late_frames) {
  MapUpdate update;
  for (const LateFramePose& frame : late_frames) {
    update.frame_timestamp_ns.push_back(frame.timestamp_ns);
    update.frame_reference_keyframe_id.push_back(frame.reference_keyframe_id);
    update.frame_camera_from_reference.push_back(ToPoseArray(frame.camera_from_reference));
  }
  for (const auto& map : atlas.maps()) {
    const MapChanges changes = map->TakeChanges();
    for (const KeyframeId id : changes.keyframes) AddKeyframe(*map, id, &update);
    for (const LandmarkId id : changes.landmarks) AddLandmark(*map->FindLandmark(id), &update);
    update.removed_landmark_id.insert(update.removed_landmark_id.end(), changes.removed_landmarks.begin(),
                                      changes.removed_landmarks.end());
  }
  return update;
}

}  // namespace kinemap
