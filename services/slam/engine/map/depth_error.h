// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "map/slam_map.h"

namespace kinemap {

/// How far off a landmark may be along the ray that knows it: one standard deviation, map frame. A pixel's error is as
/// far as the parallax of its views is small, and what a camera beside them would see is as far off; one that stands
/// where one of them stood sees it where it was. Zero where depth is measured.
///
/// @param center of the camera that looks at it, map frame.
/// @param error_rad of a view's direction, one standard deviation.
Eigen::Vector3d DepthError(const SlamMap& map, const Landmark& landmark, const Eigen::Vector3d& center,
                           double error_rad);

}  // namespace kinemap
