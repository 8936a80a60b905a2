// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "semi_dense/inverse_depth.h"
#include "semi_dense/keyframe_view.h"

namespace kinemap {

/// Checks a keyframe's inverse depths against their neighbours in the image: removes what fewer than two of the eight
/// around it support, lets pixels without an estimate take that of two neighbours that agree, and smooths (Mur-Artal
/// and Tardos 2015, section III-D). Neighbours are pixels of the same object. `pixels` are those that have gradient
/// enough to be estimated, none of them on the image's border.
void CheckAgainstNeighbors(const KeyframeView& view, const std::vector<cv::Point>& pixels,
                           InverseDepthImage* estimates);

}  // namespace kinemap
