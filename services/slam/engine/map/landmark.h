// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <map>

#include "features/descriptor.h"
#include "features/object_labels.h"
#include "map/ids.h"

namespace kinemap {

struct Landmark {
  LandmarkId id = kNoId;
  KeyframeId anchor_id = kNoId;
  Eigen::Vector3d position_in_anchor;      ///< camera frame of the anchor keyframe, map units
  std::map<KeyframeId, int> observations;  ///< keyframe -> its keypoint
  KeyframeId first_keyframe_id = kNoId;    ///< the keyframe that made it

  Descriptor descriptor{};  ///< the observation's that is nearest to all the others
  Eigen::Vector3d mean_view_direction = Eigen::Vector3d::Zero();  ///< from the cameras to the point, map frame
  double min_distance = 0, max_distance = 0;                      ///< between which the pyramid can show it

  int visible = 1;  ///< frames in which it should have been seen
  int found = 1;    ///< frames in which it was

  MotionState state = MotionState::kStatic;
  int32_t category = -1;
  uint32_t object_id = 0;
  int64_t first_seen_ns = 0;
  int64_t last_seen_ns = 0;
  int64_t valid_until_ns = kStillValid;

  /// Whether it may constrain poses.
  bool IsTrackable() const {
    return valid_until_ns == kStillValid && (state == MotionState::kStatic || state == MotionState::kNonMoving);
  }

  /// Whether this keypoint may observe it: features that stay out of tracking meet only landmarks of their own object.
  bool IsCompatibleWith(const FeatureLabel& label) const {
    if (valid_until_ns != kStillValid) return false;
    if (label.role == FeatureRole::kTracked) return IsTrackable();
    return label.role == FeatureRole::kMapped && !IsTrackable() && label.object_id == object_id;
  }
};

}  // namespace kinemap
