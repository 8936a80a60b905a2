// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "map/frame.h"
#include "map/slam_map.h"

namespace kinemap {

/// Map units per measured metre, as the median over the frame's tracked landmarks; 0 when fewer than ten of them have a
/// depth.
double MapUnitsPerMetre(const SlamMap& map, const Frame& frame);

}  // namespace kinemap
