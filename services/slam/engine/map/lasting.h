// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "features/object_labels.h"
#include "map/landmark.h"
#include "map/slam_map.h"

namespace kinemap {

/// Whether a landmark will still be where it was another time: parked cars drive off.
inline bool IsLasting(const Landmark& landmark) {
  return landmark.valid_until_ns == kStillValid && landmark.state == MotionState::kStatic;
}

/// Whether a keypoint may show such a landmark.
inline bool IsLasting(const FeatureLabel& label) {
  return label.role == FeatureRole::kTracked && label.state == MotionState::kStatic;
}

/// Such landmarks that these keyframes observe, ascending.
std::vector<LandmarkId> LastingLandmarks(const SlamMap& map, const std::vector<KeyframeId>& keyframes);

}  // namespace kinemap
