// SPDX-License-Identifier: Apache-2.0
#include "optimization/sim3_optimizer.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace kinemap {
namespace {

constexpr double kOutlierBound = 9.210;  // 99 % of chi-squared, two degrees of freedom
constexpr double kBehindCamera = 1e4;    // cost of a point that a step puts behind a camera
// Standard deviation of a triangulated depth's logarithm, and where Huber's loss turns linear.
constexpr double kDepthSigma = 0.1, kDepthHuber = 2;
constexpr int kRobustIterations = 10, kFinalIterations = 10;

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;
using PointJacobian = Eigen::Matrix<double, 3, 7>;

/// Step: translation, rotation vector, logarithm of the scale, all in the first camera's frame.
SimilarityTransform Moved(const SimilarityTransform& first_from_second, const Vector7d& step) {
  const SimilarityTransform small(RotationFromVector(step.segment<3>(3)), step.head<3>(), std::exp(step[6]));
  return small * first_from_second;
}

/// Derivative of a point in the first camera's frame by the step that moves it.
PointJacobian ByStep(const Eigen::Vector3d& point) {
  PointJacobian jacobian;
  jacobian.leftCols<3>().setIdentity();
  jacobian.middleCols<3>(3) = -CrossMatrix(point);
  jacobian.col(6) = point;
  return jacobian;
}

}  // namespace

struct Sim3Optimizer::NormalEquations {
  Matrix7d hessian = Matrix7d::Zero();
  Vector7d gradient = Vector7d::Zero();
  double cost = 0;

  void Add(const CameraModel& camera, const Eigen::Vector3d& point, const PointJacobian& point_by_step,
           const Eigen::Vector2d& pixel_px, double inverse_variance, bool robust) {
    if (point.z() <= 0) {
      cost += kBehindCamera;
      return;
    }
    const double huber = std::sqrt(kOutlierBound);
    const Eigen::Vector2d error = camera.Project(point) - pixel_px;
    const double squared = error.squaredNorm() * inverse_variance;
    double weight = inverse_variance;
    if (robust && squared > kOutlierBound) {
      cost += 2 * huber * std::sqrt(squared) - kOutlierBound;
      weight *= huber / std::sqrt(squared);
    } else {
      cost += squared;
    }
    const Eigen::Matrix<double, 2, 7> jacobian = camera.ProjectionJacobian(point) * point_by_step;
    hessian.noalias() += weight * jacobian.transpose() * jacobian;
    gradient.noalias() += weight * jacobian.transpose() * error;
  }

  /// Compares the logarithms of two depths of a point.
  void AddDepth(const Eigen::Vector3d& point, const PointJacobian& point_by_step, double depth) {
    if (point.z() <= 0 || depth <= 0) return;
    const double error = std::log(point.z() / depth) / kDepthSigma;
    double weight = 1;
    if (std::abs(error) > kDepthHuber) {
      cost += 2 * kDepthHuber * std::abs(error) - kDepthHuber * kDepthHuber;
      weight = kDepthHuber / std::abs(error);
    } else {
      cost += error * error;
    }
    const Eigen::Matrix<double, 1, 7> jacobian = point_by_step.row(2) / (point.z() * kDepthSigma);
    hessian.noalias() += weight * jacobian.transpose() * jacobian;
    gradient.noalias() += weight * error * jacobian.transpose();
  }
};

Sim3Optimizer::NormalEquations Sim3Optimizer::Linearize(const SimilarityTransform& first_from_second,
                                                        const std::vector<PointPair>& pairs,
                                                        const std::vector<bool>& inlier, bool robust) const {
  NormalEquations equations;
  const SimilarityTransform second_from_first = first_from_second.Inverse();
  const Eigen::Matrix3d turn_back = second_from_first.scale * second_from_first.rotation.toRotationMatrix();
  for (size_t i = 0; i < pairs.size(); ++i) {
    if (!inlier[i]) continue;
    const PointPair& pair = pairs[i];
    const Eigen::Vector3d in_first = first_from_second * pair.in_second;
    equations.Add(camera_, in_first, ByStep(in_first), pair.first_px, pair.first_inverse_variance, robust);
    // The inverse of a moved similarity first takes the step back from the point.
    equations.Add(camera_, second_from_first * pair.in_first, -turn_back * ByStep(pair.in_first), pair.second_px,
                  pair.second_inverse_variance, robust);
    equations.AddDepth(in_first, ByStep(in_first), pair.in_first.z());
  }
  if (fixed_scale_) {
    equations.hessian.row(6).setZero();
    equations.hessian.col(6).setZero();
    equations.hessian(6, 6) = 1;
    equations.gradient[6] = 0;
  }
  return equations;
}

SimilarityTransform Sim3Optimizer::Minimize(const SimilarityTransform& guess, const std::vector<PointPair>& pairs,
                                            const std::vector<bool>& inlier, bool robust) const {
  SimilarityTransform current = guess;
  NormalEquations equations = Linearize(current, pairs, inlier, robust);
  double damping = 1e-6;
  for (int iteration = 0; iteration < (robust ? kRobustIterations : kFinalIterations); ++iteration) {
    Matrix7d damped = equations.hessian;
    damped.diagonal() *= 1 + damping;
    damped.diagonal().array() += 1e-9;
    const Vector7d step = damped.ldlt().solve(-equations.gradient);
    if (!step.allFinite()) break;
    const SimilarityTransform moved = Moved(current, step);
    const NormalEquations next = Linearize(moved, pairs, inlier, robust);
    if (next.cost > equations.cost) {
      damping = std::max(damping, 1e-6) * 10;
      continue;
    }
    const bool converged = equations.cost - next.cost < 1e-6 * equations.cost;
    current = moved;
    equations = next;
    damping *= 0.1;
    if (converged) break;
  }
  return current;
}

Sim3Estimate Sim3Optimizer::Optimize(const SimilarityTransform& first_from_second,
                                     const std::vector<PointPair>& pairs) const {
  const std::vector<bool> all(pairs.size(), true);
  const SimilarityTransform robust = Minimize(first_from_second, pairs, all, true);
  const Sim3Estimate first = CountInliers(camera_, robust, pairs, kOutlierBound);
  return CountInliers(camera_, Minimize(robust, pairs, first.inlier, false), pairs, kOutlierBound);
}

}  // namespace kinemap
