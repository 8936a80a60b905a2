// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>

#include "map/slam_map.h"
#include "optimization/bundle_adjustment.h"

namespace kinemap {

/// Copies part of a map out to be adjusted. Moving: the live keyframes given, but for the map's first, and the
/// landmarks they see that may constrain poses. Fixed: all other keyframes that see the same landmarks.
BundleProblem CopyBundleProblem(const SlamMap& map, const std::set<KeyframeId>& moving);

/// Moves the keyframes and landmarks that still exist and erases the observations marked as outliers. Landmarks that
/// took no part move with their anchor keyframe.
void WriteBackBundle(const BundleProblem& solved, SlamMap* map);

}  // namespace kinemap
