// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/random_engine.h"

namespace kinemap {

/// Pixels of one point in two undistorted views.
struct PixelPair {
  Eigen::Vector2d first_px;
  Eigen::Vector2d second_px;
};

/// A homography (second ~ H first) or fundamental matrix (second^T F first = 0) that RANSAC found.
struct TwoViewModel {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  double score = 0;  ///< sum over inliers of 5.99 - error^2, both directions (ORB-SLAM, 2015, eq. 2)
  std::vector<bool> inlier;
};

/// Both need at least 8 pairs and give score 0 otherwise. Errors are in units of `sigma_px`.
TwoViewModel EstimateHomography(const std::vector<PixelPair>& pairs, double sigma_px, int iterations,
                                RandomEngine& random);
TwoViewModel EstimateFundamental(const std::vector<PixelPair>& pairs, double sigma_px, int iterations,
                                 RandomEngine& random);

}  // namespace kinemap
