// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "map/frame.h"
#include "map/slam_map.h"

namespace kinemap {

/// Depth at a keypoint in metres; 0 where unknown. `depth_m` is CV_32F, 0 or NaN where unknown.
double DepthAt(const cv::Mat& depth_m, const Keypoint& keypoint);

/// Map units per metre of the depth image, as the median over the frame's tracked landmarks; 0 when fewer than ten of
/// them have a depth or there is no depth image.
double MapUnitsPerMetre(const SlamMap& map, const Frame& frame, const cv::Mat& depth_m);

}  // namespace kinemap
