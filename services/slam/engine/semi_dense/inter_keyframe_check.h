// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "geometry/camera_model.h"
#include "geometry/similarity_transform.h"
#include "semi_dense/inverse_depth.h"

namespace kinemap {

/// Another keyframe's inverse depths, and where it stands.
struct OtherEstimates {
  const InverseDepthImage* estimates;
  SimilarityTransform other_from_own;  ///< between what is anchored in the two keyframes
};

/// Checks a keyframe's inverse depths against those of others: what fewer than `least_consistent` of them confirm is
/// removed, the rest becomes the weighted mean of all that agree (Mur-Artal and Tardos 2015, section III-E; its
/// Gauss-Newton step is this mean, taken in inverse depth). `estimates` is changed in place.
void CheckAgainstKeyframes(const CameraModel& camera, const std::vector<cv::Point>& pixels,
                           const std::vector<OtherEstimates>& others, int least_consistent,
                           InverseDepthImage* estimates);

}  // namespace kinemap
