// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "geometry/camera_model.h"
#include "geometry/random_engine.h"
#include "geometry/similarity_transform.h"

namespace kinemap {

/// One thing that two cameras see, placed by each in its own frame and units.
struct PointPair {
  Eigen::Vector3d in_first, in_second;
  Eigen::Vector2d first_px, second_px;
  double first_inverse_variance, second_inverse_variance;  ///< 1 / px^2
};

struct Sim3Estimate {
  SimilarityTransform first_from_second;
  std::vector<bool> inlier;  ///< one a pair
  int inliers = 0;
};

/// Marks the pairs whose squared errors, the second camera's point in the first image and the other way round, are both
/// at most `bound` variances.
Sim3Estimate CountInliers(const CameraModel& camera, const SimilarityTransform& first_from_second,
                          const std::vector<PointPair>& pairs, double bound);

struct Sim3RansacOptions {
  int iterations = 300;
  int min_inliers = 15;
  double bound = 9.210;  ///< 99 % of chi-squared, two degrees of freedom
  bool fixed_scale = false;
};

/// Aligns samples of three pairs (`AlignPoints`), keeps what most pairs agree with in both images, and fits once more
/// to all of these. Nothing when fewer than `min_inliers` agree.
std::optional<Sim3Estimate> EstimateSim3(const CameraModel& camera, const std::vector<PointPair>& pairs,
                                         const Sim3RansacOptions& options, RandomEngine& random);

}  // namespace kinemap
