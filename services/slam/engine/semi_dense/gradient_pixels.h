// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "semi_dense/keyframe_view.h"

namespace kinemap {

/// The pixels of a view, row by row and `margin_px` inside its border, whose gradient is at least `least_gradient` grey
/// levels a pixel; when they are more than `most`, only the strongest, as far as whole grey levels tell them apart.
/// Pixels on moving objects, and those that belong to nobody, are left out.
std::vector<cv::Point> FindGradientPixels(const KeyframeView& view, float least_gradient, int most, int margin_px);

}  // namespace kinemap
