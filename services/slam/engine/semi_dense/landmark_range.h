// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "map/slam_map.h"
#include "semi_dense/keyframe_view.h"

namespace kinemap {

/// The range in which a keyframe's scene lies, by the trackable landmarks it observes; unknown with fewer than ten.
DepthRange RangeOfLandmarks(const SlamMap& map, KeyframeId keyframe_id);

}  // namespace kinemap
