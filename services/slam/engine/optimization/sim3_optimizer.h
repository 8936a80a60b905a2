// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "geometry/camera_model.h"
#include "geometry/sim3_ransac.h"

namespace kinemap {

/// Similarity between two cameras that see the same points: Levenberg-Marquardt on the reprojection error in both
/// images with Huber's loss, over the seven numbers of the similarity alone; pairs beyond the bound are left out before
/// a second, quadratic round (Mur-Artal, Montiel and Tardos 2015, section VII-B). Two cameras in one place see the same
/// at any scale, so that the points' depths are compared too.
class Sim3Optimizer {
 public:
  /// With `fixed_scale` the scale stays that of the first guess.
  Sim3Optimizer(const CameraModel& camera, bool fixed_scale) : camera_(camera), fixed_scale_(fixed_scale) {}

  Sim3Estimate Optimize(const SimilarityTransform& first_from_second, const std::vector<PointPair>& pairs) const;

 private:
  struct NormalEquations;
  NormalEquations Linearize(const SimilarityTransform& first_from_second, const std::vector<PointPair>& pairs,
                            const std::vector<bool>& inlier, bool robust) const;
  SimilarityTransform Minimize(const SimilarityTransform& guess, const std::vector<PointPair>& pairs,
                               const std::vector<bool>& inlier, bool robust) const;

  CameraModel camera_;
  bool fixed_scale_;
};

}  // namespace kinemap
