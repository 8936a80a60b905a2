// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "loop_closing/essential_graph.h"
#include "map/slam_map.h"
#include "optimization/map_bundle.h"

namespace kinemap {

/// Moves every live keyframe by its correction, and those without one, made since it was computed, by that of the
/// corrected keyframe they share most landmarks with. Landmarks go with their anchors.
void ApplyCorrections(const Corrections& corrections, SlamMap* map);

/// Writes an adjustment of the whole map back; keyframes and landmarks made since it was copied follow.
void ApplyAdjustment(const BundleProblem& solved, SlamMap* map);

}  // namespace kinemap
