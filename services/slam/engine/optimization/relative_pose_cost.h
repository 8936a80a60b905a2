// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/manifold.h>
#include <ceres/sized_cost_function.h>

#include "geometry/similarity_transform.h"

namespace kinemap {

/// A similarity map_from_node as Ceres sees it: quaternion x, y, z, w, then translation, then the scale's logarithm.
constexpr int kSimilaritySize = 8;

void WriteSimilarity(const SimilarityTransform& transform, double* values);
SimilarityTransform ReadSimilarity(const double* values);

/// Steps of translation (map frame), rotation vector (node's frame) and, unless the scale is fixed, its logarithm. Its
/// Jacobian is the unit matrix over a row of zeros: the cost gives the derivative by the step itself, which spares a
/// matrix product.
class SimilarityManifold : public ceres::Manifold {
 public:
  explicit SimilarityManifold(bool fixed_scale) : tangent_size_(fixed_scale ? 6 : 7) {}

  int AmbientSize() const override { return kSimilaritySize; }
  int TangentSize() const override { return tangent_size_; }
  bool Plus(const double* values, const double* step, double* moved) const override;
  bool PlusJacobian(const double* values, double* jacobian) const override;
  bool Minus(const double* to, const double* from, double* step) const override;
  bool MinusJacobian(const double* values, double* jacobian) const override;

 private:
  int tangent_size_;
};

/// Inverse standard deviations of an edge.
struct RelativePoseWeights {
  double translation, rotation, scale;
};

/// Difference between two nodes' relative pose and the measured `first_from_second`, in standard deviations:
/// translation in the first node's frame and units, twice the vector part of the turn's quaternion, logarithm of the
/// scale.
class RelativePoseCost : public ceres::SizedCostFunction<7, kSimilaritySize, kSimilaritySize> {
 public:
  RelativePoseCost(const SimilarityTransform& first_from_second, const RelativePoseWeights& weights)
      : measured_(first_from_second), weights_(weights) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  SimilarityTransform measured_;
  RelativePoseWeights weights_;
};

}  // namespace kinemap
