// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "semi_dense/inverse_depth.h"

namespace kinemap {

/// One estimate out of what several keyframe pairs say of a pixel: the weighted mean of the largest set that agrees
/// with one of them, the first of two as large. Unknown when that has fewer than `least_agreeing` members (Mur-Artal
/// and Tardos 2015, section III-C).
InverseDepth FuseHypotheses(const std::vector<InverseDepth>& hypotheses, int least_agreeing);

}  // namespace kinemap
