// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "map/atlas.h"
#include "semi_dense/semi_dense_cloud.h"

namespace kinemap {

/// tx ty tz qx qy qz qw
using PoseArray = std::array<double, 7>;

PoseArray ToPoseArray(const RigidTransform& transform);

/// Pose of a frame that became known after its turn.
struct LateFramePose {
  int64_t timestamp_ns;
  KeyframeId reference_keyframe_id;
  RigidTransform camera_from_reference;
};

/// What changed in the map since the last update, one column a vector.
struct MapUpdate {
  std::vector<KeyframeId> keyframe_id;
  std::vector<int64_t> keyframe_timestamp_ns;
  std::vector<int64_t> keyframe_map_id;
  std::vector<std::array<double, 8>> keyframe_pose;  ///< map_from_keyframe: tx ty tz qx qy qz qw scale
  std::vector<uint8_t> keyframe_culled;
  std::vector<KeyframeId> keyframe_parent_id;  ///< of a culled keyframe, else -1

  std::vector<LandmarkId> landmark_id;
  std::vector<KeyframeId> landmark_anchor_id;
  std::vector<std::array<float, 3>> landmark_position;  ///< in the anchor's camera frame
  std::vector<uint8_t> landmark_state;
  std::vector<int32_t> landmark_category;
  std::vector<uint32_t> landmark_object_id;
  std::vector<int64_t> landmark_first_seen_ns;
  std::vector<int64_t> landmark_last_seen_ns;
  std::vector<int64_t> landmark_valid_until_ns;
  std::vector<LandmarkId> removed_landmark_id;

  // Semi-dense maps that were finished. A keyframe's points are `dense_keyframe_points` rows of what follows.
  std::vector<KeyframeId> dense_keyframe_id;
  std::vector<int32_t> dense_keyframe_points;
  std::vector<std::array<float, 3>> dense_point_position;  ///< in the keyframe's camera frame
  std::vector<float> dense_point_depth_sigma;
  std::vector<uint8_t> dense_point_grey;
  std::vector<uint8_t> dense_point_state;
  std::vector<int16_t> dense_point_category;
  std::vector<uint32_t> dense_point_object_id;

  std::vector<int64_t> frame_timestamp_ns;
  std::vector<KeyframeId> frame_reference_keyframe_id;
  std::vector<PoseArray> frame_camera_from_reference;
};

void AddSemiDense(const std::vector<SemiDenseCloud>& clouds, MapUpdate* update);

/// Takes the changes out of every map and adds the late frame poses.
MapUpdate TakeMapUpdate(const Atlas& atlas, const std::vector<LateFramePose>& late_frames);

}  // namespace kinemap
