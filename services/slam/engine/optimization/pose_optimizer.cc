// SPDX-License-Identifier: Apache-2.0
#include "optimization/pose_optimizer.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace kinemap {
namespace {

constexpr double kOutlierBound = 5.991;        // 95 % of chi-squared, two degrees of freedom
constexpr double kStereoOutlierBound = 7.815;  // three
constexpr double kPriorBound = 12.592;         // six
constexpr double kFarthestExpected = 22.458;   // 99.9 %
constexpr int kRounds = 4;
constexpr int kRobustRounds = 2;
constexpr int kIterations = 10;
constexpr int kLeastObservations = 3;
constexpr double kBehindCamera = 1e9;

double OutlierBound(const PoseObservation& observation) {
  return std::isnan(observation.right_x_px) ? kOutlierBound : kStereoOutlierBound;
}

/// Error in the right image, in px; 0 where there is none.
double RightError(const CameraModel& camera, const PoseObservation& observation, const Eigen::Vector3d& point) {
  return std::isnan(observation.right_x_px) ? 0 : camera.RightX(point) - observation.right_x_px;
}

/// Inverse covariance of the pixel's error and of what the point's own shows of in the image, 1 / px^2.
Eigen::Matrix2d Information(const PoseObservation& observation, const Eigen::Matrix<double, 2, 3>& by_point_in_map) {
  const Eigen::Vector2d shown_px = by_point_in_map * observation.depth_error;
  const double variance = 1 / observation.inverse_variance;
  return observation.inverse_variance *
         (Eigen::Matrix2d::Identity() - shown_px * shown_px.transpose() / (variance + shown_px.squaredNorm()));
}

}  // namespace

bool PosePrior::Contains(const RigidTransform& pose) const {
  const Vector6d step = pose.StepInTargetFrom(camera_from_map);
  return step.dot(information * step) <= kFarthestExpected;
}

struct PoseOptimizer::NormalEquations {
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  double cost = 0;
};

PoseOptimizer::NormalEquations PoseOptimizer::Linearize(const RigidTransform& camera_from_map,
                                                        const std::vector<PoseObservation>& observations,
                                                        const std::vector<bool>& inlier, bool robust) const {
  NormalEquations equations;
  const Eigen::Matrix3d rotation = camera_from_map.rotation.toRotationMatrix();
  for (size_t i = 0; i < observations.size(); ++i) {
    if (!inlier[i]) continue;
    const Eigen::Vector3d point = rotation * observations[i].point_in_map + camera_from_map.translation;
    if (point.z() <= 0) {
      equations.cost += kBehindCamera;
      continue;
    }
    const Eigen::Vector2d error = camera_.Project(point) - observations[i].pixel_px;
    const double right_error = RightError(camera_, observations[i], point);
    const Eigen::Matrix<double, 2, 3> projection = camera_.ProjectionJacobian(point);
    const Eigen::Matrix2d information = Information(observations[i], projection * rotation);
    const double squared =
        error.dot(information * error) + right_error * right_error * observations[i].inverse_variance;
    const double bound = OutlierBound(observations[i]), huber = std::sqrt(bound);
    double weight = 1;
    if (robust && squared > bound) {
      equations.cost += 2 * huber * std::sqrt(squared) - bound;
      weight *= huber / std::sqrt(squared);
    } else {
      equations.cost += squared;
    }
    Eigen::Matrix<double, 2, 6> jacobian;
    jacobian.leftCols<3>() = projection;
    jacobian.rightCols<3>() = -projection * CrossMatrix(point);
    const Eigen::Matrix<double, 6, 2> weighted = weight * jacobian.transpose() * information;
    equations.hessian.noalias() += weighted * jacobian;
    equations.gradient.noalias() += weighted * error;
    if (std::isnan(observations[i].right_x_px)) continue;
    weight *= observations[i].inverse_variance;
    const Eigen::RowVector3d right_projection = camera_.RightXJacobian(point);
    Vector6d right_jacobian;
    right_jacobian << right_projection.transpose(), point.cross(right_projection.transpose());
    equations.hessian.noalias() += weight * right_jacobian * right_jacobian.transpose();
    equations.gradient.noalias() += weight * right_error * right_jacobian;
  }
  return equations;
}

void PoseOptimizer::AddPrior(const PosePrior& prior, const RigidTransform& camera_from_map,
                             NormalEquations* equations) const {
  const Vector6d step = camera_from_map.StepInTargetFrom(prior.camera_from_map);
  const double squared = step.dot(prior.information * step);
  const double weight = squared > kPriorBound ? std::sqrt(kPriorBound / squared) : 1;
  equations->cost += squared > kPriorBound ? 2 * std::sqrt(kPriorBound * squared) - kPriorBound : squared;
  equations->hessian += weight * prior.information;
  equations->gradient += weight * prior.information * step;
}

PoseEstimate PoseOptimizer::Optimize(const RigidTransform& initial_camera_from_map,
                                     const std::vector<PoseObservation>& observations,
                                     const std::optional<PosePrior>& prior) const {
  const auto linearize = [&](const RigidTransform& camera_from_map, const std::vector<bool>& inlier, bool robust) {
    NormalEquations equations = Linearize(camera_from_map, observations, inlier, robust);
    if (prior) AddPrior(*prior, camera_from_map, &equations);
    return equations;
  };
  PoseEstimate estimate;
  estimate.camera_from_map = initial_camera_from_map;
  estimate.inlier.assign(observations.size(), true);
  if (observations.size() < kLeastObservations) {
    estimate.inlier.assign(observations.size(), false);
    return estimate;
  }
  for (int round = 0; round < kRounds; ++round) {
    const bool robust = round < kRobustRounds;
    double damping = 1e-6;
    NormalEquations equations = linearize(estimate.camera_from_map, estimate.inlier, robust);
    for (int iteration = 0; iteration < kIterations; ++iteration) {
      Matrix6d damped = equations.hessian;
      damped.diagonal() *= 1 + damping;
      damped.diagonal().array() += 1e-9;
      const Vector6d step = damped.ldlt().solve(-equations.gradient);
      if (!step.allFinite()) break;
      const RigidTransform moved = estimate.camera_from_map.PerturbedInTarget(step);
      const NormalEquations next = linearize(moved, estimate.inlier, robust);
      if (next.cost > equations.cost) {
        damping = std::max(damping, 1e-6) * 10;
        if (damping > 1e4) break;
        continue;
      }
      const bool converged = equations.cost - next.cost < 1e-6 * equations.cost;
      estimate.camera_from_map = moved;
      equations = next;
      damping *= 0.1;
      if (converged) break;
    }
    estimate.inliers = 0;
    const Eigen::Matrix3d rotation = estimate.camera_from_map.rotation.toRotationMatrix();
    for (size_t i = 0; i < observations.size(); ++i) {
      const Eigen::Vector3d point = estimate.camera_from_map * observations[i].point_in_map;
      const Eigen::Vector2d error = camera_.Project(point) - observations[i].pixel_px;
      const double right_error = RightError(camera_, observations[i], point);
      const double squared =
          error.dot(Information(observations[i], camera_.ProjectionJacobian(point) * rotation) * error) +
          right_error * right_error * observations[i].inverse_variance;
      estimate.inlier[i] = point.z() > 0 && squared <= OutlierBound(observations[i]);
      estimate.inliers += estimate.inlier[i] ? 1 : 0;
    }
    if (estimate.inliers < kLeastObservations) return estimate;
  }
  estimate.information = linearize(estimate.camera_from_map, estimate.inlier, false).hessian;
  return estimate;
}

}  // namespace kinemap
