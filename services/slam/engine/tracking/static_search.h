// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "geometry/camera_model.h"
#include "map/frame.h"
#include "map/lasting.h"
#include "map/slam_map.h"

namespace kinemap {

/// Static landmarks that these keyframes observe, each once, in the keyframes' order.
std::vector<LandmarkId> StaticLandmarks(const SlamMap& map, const std::vector<KeyframeId>& keyframes);

/// Matches static landmarks that the frame does not match yet with its free keypoints near where its pose puts them.
/// `radius_px` is that of the finest octave. Returns how many matches were added.
int ProjectStaticLandmarks(const SlamMap& map, const CameraModel& camera, const std::vector<LandmarkId>& landmarks,
                           double radius_px, int max_distance, Frame* frame);

}  // namespace kinemap
