// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "geometry/camera_model.h"
#include "map/frame.h"
#include "map/slam_map.h"

namespace kinemap {

/// Whether a landmark will be where it was another day: parked cars drive off.
inline bool IsLasting(const Landmark& landmark) {
  return landmark.valid_until_ns == kStillValid && landmark.state == MotionState::kStatic;
}

/// Static landmarks that these keyframes observe, each once, in the keyframes' order.
std::vector<LandmarkId> StaticLandmarks(const SlamMap& map, const std::vector<KeyframeId>& keyframes);

/// Matches static landmarks that the frame does not match yet with its free keypoints near where its pose puts them.
/// `radius_px` is that of the finest octave. Returns how many matches were added.
int ProjectStaticLandmarks(const SlamMap& map, const CameraModel& camera, const std::vector<LandmarkId>& landmarks,
                           double radius_px, int max_distance, Frame* frame);

}  // namespace kinemap
