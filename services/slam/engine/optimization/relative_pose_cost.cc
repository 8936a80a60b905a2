// SPDX-License-Identifier: Apache-2.0
#include "optimization/relative_pose_cost.h"

#include <cmath>

namespace kinemap {

void WriteSimilarity(const SimilarityTransform& transform, double* values) {
  Eigen::Map<Eigen::Vector4d>(values, 4) = transform.rotation.coeffs();
  Eigen::Map<Eigen::Vector3d>(values + 4, 3) = transform.translation;
  values[7] = std::log(transform.scale);
}

SimilarityTransform ReadSimilarity(const double* values) {
  return {Eigen::Quaterniond(values[3], values[0], values[1], values[2]),
          Eigen::Vector3d(values[4], values[5], values[6]), std::exp(values[7])};
}

bool SimilarityManifold::Plus(const double* values, const double* step, double* moved) const {
  SimilarityTransform transform = ReadSimilarity(values);
  const Eigen::Map<const Eigen::Vector3d> shift(step), turn(step + 3);
  transform.translation += shift;
  transform.rotation = (transform.rotation * RotationFromVector(turn)).normalized();
  WriteSimilarity(transform, moved);
  moved[7] = values[7] + (tangent_size_ == 7 ? step[6] : 0.0);
  return true;
}

bool SimilarityManifold::PlusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, kSimilaritySize, Eigen::Dynamic, Eigen::RowMajor>> matrix(jacobian, kSimilaritySize,
                                                                                             tangent_size_);
  matrix.setIdentity();
  return true;
}

bool SimilarityManifold::Minus(const double* to, const double* from, double* step) const {
  const SimilarityTransform target = ReadSimilarity(to), source = ReadSimilarity(from);
  const Eigen::AngleAxisd turn(source.rotation.conjugate() * target.rotation);
  Eigen::Map<Eigen::Vector3d>(step, 3) = target.translation - source.translation;
  Eigen::Map<Eigen::Vector3d>(step + 3, 3) = turn.angle() * turn.axis();
  if (tangent_size_ == 7) step[6] = to[7] - from[7];
  return true;
}

bool SimilarityManifold::MinusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, kSimilaritySize, Eigen::RowMajor>> matrix(jacobian, tangent_size_,
                                                                                             kSimilaritySize);
  matrix.setIdentity();
  return true;
}

bool RelativePoseCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const SimilarityTransform first = ReadSimilarity(parameters[0]), second = ReadSimilarity(parameters[1]);
  const Eigen::Matrix3d to_first = first.rotation.conjugate().toRotationMatrix() / first.scale;
  const Eigen::Vector3d second_in_first = to_first * (second.translation - first.translation);
  Eigen::Quaterniond turn = measured_.rotation.conjugate() * first.rotation.conjugate() * second.rotation;
  if (turn.w() < 0) turn.coeffs() = -turn.coeffs();

  Eigen::Map<Eigen::Matrix<double, 7, 1>> residual(residuals);
  residual.head<3>() = weights_.translation * (second_in_first - measured_.translation);
  residual.segment<3>(3) = 2 * weights_.rotation * turn.vec();
  residual[6] = weights_.scale * (parameters[1][7] - parameters[0][7] - std::log(measured_.scale));
  if (jacobians == nullptr) return true;

  using Jacobian = Eigen::Matrix<double, 7, kSimilaritySize, Eigen::RowMajor>;
  const Eigen::Matrix3d real_part = turn.w() * Eigen::Matrix3d::Identity(), cross = CrossMatrix(turn.vec());
  if (jacobians[0] != nullptr) {
    Eigen::Map<Jacobian> by_first(jacobians[0]);
    by_first.setZero();
    by_first.block<3, 3>(0, 0) = -weights_.translation * to_first;
    by_first.block<3, 3>(0, 3) = weights_.translation * CrossMatrix(second_in_first);
    by_first.block<3, 1>(0, 6) = -weights_.translation * second_in_first;
    by_first.block<3, 3>(3, 3) =
        -weights_.rotation * (real_part - cross) * measured_.rotation.conjugate().toRotationMatrix();
    by_first(6, 6) = -weights_.scale;
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<Jacobian> by_second(jacobians[1]);
    by_second.setZero();
    by_second.block<3, 3>(0, 0) = weights_.translation * to_first;
    by_second.block<3, 3>(3, 3) = weights_.rotation * (real_part + cross);
    by_second(6, 6) = weights_.scale;
  }
  return true;
}

}  // namespace kinemap
