// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "geometry/camera_model.h"
#include "map/frame.h"
#include "map/slam_map.h"

namespace kinemap {

/// Matches landmarks that the frame does not match yet with its free keypoints near where its pose puts them.
/// `radius_px` is that of the finest octave. Returns how many matches were added.
int ProjectLandmarks(const SlamMap& map, const CameraModel& camera, const std::vector<LandmarkId>& landmarks,
                     double radius_px, int max_distance, Frame* frame);

}  // namespace kinemap
