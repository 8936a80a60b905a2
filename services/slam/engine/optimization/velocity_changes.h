// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "map/slam_map.h"
#include "optimization/bundle_adjustment.h"

namespace kinemap {

/// Which of a problem's cameras followed each other closely enough that the speed of one tells of the next's, and how
/// much it tells: the velocity is a random walk, its steps a part of the top speed around that time, so that slow
/// cameras change it by a larger ratio. None where depths are measured: they hold the scale.
std::vector<VelocityChange> VelocityChanges(const SlamMap& map, const BundleProblem& problem);

}  // namespace kinemap
