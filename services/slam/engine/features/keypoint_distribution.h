// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "features/corner.h"

namespace kinemap {

/// Chooses about `count` of the corners so that they cover the area evenly: it is split like a quadtree, the fullest
/// part first, until there are `count` parts; each keeps its strongest corner (the idea of ORB-SLAM, 2015, section
/// III-C). The order of the result depends on nothing but the input.
std::vector<Corner> DistributeEvenly(const std::vector<Corner>& corners, const cv::Rect& area_px, int count);

}  // namespace kinemap
