// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "geometry/rigid_transform.h"
#include "ground/object_contacts.h"
#include "map/ids.h"

namespace kinemap {

enum class TrackingState : int { kInitializing = 0, kTracking = 1, kLost = 2 };

/// Wall-clock milliseconds of each step of one frame; for reports only, no result depends on them.
struct StageTimes {
  double extract_ms = 0;    ///< begin_frame
  double merge_ms = 0;      ///< waiting for and merging the background's bundle adjustment
  double match_ms = 0;      ///< first pose: last frame, reference keyframe or relocalisation; or initialisation
  double local_map_ms = 0;  ///< search in the local map and final pose
  double mapping_ms = 0;    ///< keyframe insertion
  double loop_ms = 0;       ///< looking for a loop, and merging what came of one
};

struct TrackingResult {
  int64_t timestamp_ns = 0;
  TrackingState state = TrackingState::kInitializing;
  std::string reason;  ///< why there is no pose; empty when there is one
  int64_t map_id = 0;
  /// Not a number while there is no pose.
  Eigen::Matrix4d map_from_camera = Eigen::Matrix4d::Constant(std::numeric_limits<double>::quiet_NaN());
  /// Of (translation, rotation vector) as a step in the camera frame; map units^2, rad^2. Not a number without a pose.
  Matrix6d covariance = Matrix6d::Constant(std::numeric_limits<double>::quiet_NaN());
  KeyframeId reference_keyframe_id = kNoId;
  Eigen::Matrix4d camera_from_reference = Eigen::Matrix4d::Constant(std::numeric_limits<double>::quiet_NaN());
  int tracked_landmarks = 0;
  int features = 0;
  bool keyframe_inserted = false;
  int moving_unplaced = 0;  ///< features on moving objects that this keyframe had no depth for
  Eigen::Vector3d road_normal = Eigen::Vector3d::Zero();  ///< down, camera frame; 0 where no road is known
  double road_distance = 0;                               ///< of the camera from the road, map units
  std::vector<ObjectContact> object_contacts;             ///< camera frame, map units
  bool metric_scale = false;
  bool loop_closed = false;  ///< a place of this map was recognised; many keyframes moved
  bool maps_merged = false;  ///< a place of another map was recognised; map_id may have changed
  double background_ms = 0;  ///< processor time, beside tracking, of what was merged of loops
  StageTimes stage_ms;
};

}  // namespace kinemap
