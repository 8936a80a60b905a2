// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "geometry/rigid_transform.h"
#include "optimization/pose_optimizer.h"

namespace kinemap {

using Matrix12d = Eigen::Matrix<double, 12, 12>;

/// What the motion model carries from frame to frame.
struct CameraMotion {
  std::optional<RigidTransform> velocity;    ///< current camera from last camera
  Matrix12d covariance = Matrix12d::Zero();  ///< of a step of the pose, and a step of the velocity
  double turn_noise = 0;                     ///< variance of the velocity's change in a frame, rad^2, on each axis
  double shift_noise = 0;                    ///< the same of its translation, map units^2
  double depth = 0;                          ///< typical distance of the landmarks, map units
};

/// Where the camera is expected, and how far from there it may be.
struct PredictedPose {
  RigidTransform camera_from_map;
  Matrix12d covariance;  ///< of a step of this pose in the camera frame, and a step of the velocity

  Matrix6d PoseCovariance() const { return covariance.topLeftCorner<6, 6>(); }
  PosePrior Prior() const;
  /// How far from its predicted pixel a landmark at this distance may be seen (99 %), px on each axis.
  double RadiusPx(double focal_px, double distance) const;
};

/// The camera is expected to go on as it moved: a Kalman filter over pose and velocity whose process noise is white
/// acceleration. How much the camera accelerates is learned from how far predictions were off (Mehra 1970), but never
/// thought to be less than a tenth of a degree a frame, and what shifts the landmarks in the image as far.
class MotionModel {
 public:
  /// Begins with the motion between two consecutive frames (camera_from_map); `depth`: typical distance of landmarks.
  void Start(const RigidTransform& last, const RigidTransform& current, double depth);

  /// Lengths count `factor` times what they did.
  void Rescale(double factor);
  void Reset() { state_.velocity.reset(); }

  /// As another motion model knew it.
  void Restore(const CameraMotion& state) { state_ = state; }
  const CameraMotion& state() const { return state_; }
  bool IsKnown() const { return state_.velocity.has_value(); }

  /// The pose `frames` frames after `last`, the newest pose this was corrected with.
  PredictedPose Predict(const RigidTransform& last, int frames = 1) const;

  /// Takes in the pose that was found with the prediction as its prior; `information` is of both together.
  void Correct(const PredictedPose& predicted, const RigidTransform& found, const Matrix6d& information);

 private:
  void LearnNoise(const PredictedPose& predicted, const Vector6d& innovation, const Matrix6d& by_landmarks);

  CameraMotion state_;
};

}  // namespace kinemap
