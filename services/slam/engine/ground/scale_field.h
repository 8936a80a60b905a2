// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "map/slam_map.h"

namespace kinemap {

/// By how much the surroundings of a keyframe are to grow: the logarithm of the factor.
struct ScaleChange {
  KeyframeId keyframe_id;
  double log_factor;
};

/// Rescales a map along its keyframes: each keyframe's landmarks grow by its factor, and the way from each to the next
/// by the mean of the two. The first of `changes` (live keyframes in the order of their time) stays where it is,
/// directions stay what they are, and equal factors scale the map about it.
void ApplyScaleField(const std::vector<ScaleChange>& changes, SlamMap* map);

}  // namespace kinemap
