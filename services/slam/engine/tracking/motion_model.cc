// SPDX-License-Identifier: Apache-2.0
#include "tracking/motion_model.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>

namespace kinemap {
namespace {

constexpr double kLeastTurn = 0.1 * EIGEN_PI / 180;  // a frame and frame, of a car's gentle steering
constexpr double kFirstTurn = 1.0 * EIGEN_PI / 180;  // before anything is known of the motion
constexpr double kForget = 0.2;                      // share of the newest frame in the noise
constexpr double kSigmas = 3;
constexpr double kLeastPrecision = 1e-12;

/// How a step in the source frame of `motion` appears in its target frame.
Matrix6d Adjoint(const RigidTransform& motion) {
  const Eigen::Matrix3d rotation = motion.rotation.toRotationMatrix();
  Matrix6d adjoint = Matrix6d::Zero();
  adjoint.topLeftCorner<3, 3>() = rotation;
  adjoint.bottomRightCorner<3, 3>() = rotation;
  adjoint.topRightCorner<3, 3>() = CrossMatrix(motion.translation) * rotation;
  return adjoint;
}

double Square(double value) { return value * value; }

}  // namespace

PosePrior PredictedPose::Prior() const {
  Matrix6d covariance_of_pose = PoseCovariance();
  covariance_of_pose.diagonal().array() += kLeastPrecision;
  return {camera_from_map, covariance_of_pose.inverse()};
}

double PredictedPose::RadiusPx(double focal_px, double distance) const {
  const Matrix6d of_pose = PoseCovariance();
  const double shift = of_pose.diagonal().head<3>().maxCoeff() / Square(distance);
  const double turn = of_pose.diagonal().tail<3>().maxCoeff();
  return kSigmas * focal_px * std::sqrt(shift + turn);
}

void MotionModel::Start(const RigidTransform& last, const RigidTransform& current, double depth) {
  state_.depth = depth;
  state_.turn_noise = Square(kFirstTurn);
  state_.shift_noise = Square(kFirstTurn * depth);
  state_.velocity = current * last.Inverse();
  state_.covariance.setZero();
  state_.covariance.diagonal().segment<3>(6).setConstant(Square(kFirstTurn * state_.depth));
  state_.covariance.diagonal().segment<3>(9).setConstant(Square(kFirstTurn));
}

void MotionModel::Rescale(double factor) {
  if (!state_.velocity) return;
  state_.velocity->translation *= factor;
  Eigen::Matrix<double, 12, 1> scale;
  scale << Eigen::Vector3d::Constant(factor), Eigen::Vector3d::Ones(), Eigen::Vector3d::Constant(factor),
      Eigen::Vector3d::Ones();
  state_.covariance = (scale.asDiagonal() * state_.covariance * scale.asDiagonal()).eval();
  state_.shift_noise *= factor * factor;
  state_.depth *= factor;
}

PredictedPose MotionModel::Predict(const RigidTransform& last, int frames) const {
  PredictedPose predicted{last, state_.covariance};
  Vector6d noise;
  noise << Eigen::Vector3d::Constant(state_.shift_noise), Eigen::Vector3d::Constant(state_.turn_noise);
  // The velocity changes before it moves the camera, so both get the same change.
  Matrix12d process = Matrix12d::Zero();
  for (const int row : {0, 6}) {
    for (const int column : {0, 6}) process.block<6, 6>(row, column) = noise.asDiagonal();
  }
  Matrix12d transition = Matrix12d::Identity();
  transition.topLeftCorner<6, 6>() = Adjoint(*state_.velocity);
  transition.topRightCorner<6, 6>().setIdentity();
  for (int i = 0; i < frames; ++i) {
    predicted.camera_from_map = *state_.velocity * predicted.camera_from_map;
    predicted.covariance = (transition * predicted.covariance * transition.transpose() + process).eval();
  }
  return predicted;
}

void MotionModel::Correct(const PredictedPose& predicted, const RigidTransform& found, const Matrix6d& information) {
  const Vector6d innovation = found.StepInTargetFrom(predicted.camera_from_map);
  const PosePrior prior = predicted.Prior();
  const Matrix6d pose_from_both = information.inverse();
  const Matrix6d gain = predicted.covariance.bottomLeftCorner<6, 6>() * prior.information;
  if (!pose_from_both.allFinite() || !gain.allFinite()) return;
  LearnNoise(predicted, innovation, information - prior.information);
  state_.velocity = state_.velocity->PerturbedInTarget(gain * innovation);
  const Matrix6d less = predicted.PoseCovariance() - pose_from_both;
  state_.covariance.topLeftCorner<6, 6>() = pose_from_both;
  state_.covariance.bottomLeftCorner<6, 6>() = gain * pose_from_both;
  state_.covariance.topRightCorner<6, 6>() = (gain * pose_from_both).transpose();
  state_.covariance.bottomRightCorner<6, 6>() =
      predicted.covariance.bottomRightCorner<6, 6>() - gain * less * gain.transpose();
}

void MotionModel::LearnNoise(const PredictedPose& predicted, const Vector6d& innovation, const Matrix6d& by_landmarks) {
  const Eigen::LDLT<Matrix6d> solver(by_landmarks);
  if (solver.info() != Eigen::Success || !solver.isPositive()) return;
  const Vector6d measured = solver.solve(Matrix6d::Identity()).diagonal();
  if (!measured.allFinite() || measured.minCoeff() <= 0) return;
  // A point at distance d moves in the image by the shift over d, or by the turn.
  const double shift_information = by_landmarks.topLeftCorner<3, 3>().trace();
  const double depth = std::sqrt(by_landmarks.bottomRightCorner<3, 3>().trace() / shift_information);
  if (state_.depth == 0) state_.depth = depth;
  state_.depth += kForget * (depth - state_.depth);
  const Vector6d known = predicted.PoseCovariance().diagonal() + measured;
  const auto learned = [&](double noise, double least, int row) {
    const double unexplained = innovation.segment<3>(row).squaredNorm() - known.segment<3>(row).sum() + 3 * noise;
    return std::max(least, noise + kForget * (std::max(0.0, unexplained) - noise));
  };
  state_.shift_noise = learned(state_.shift_noise, Square(kLeastTurn * state_.depth), 0);
  state_.turn_noise = learned(state_.turn_noise, Square(kLeastTurn), 3);
}

}  // namespace kinemap
