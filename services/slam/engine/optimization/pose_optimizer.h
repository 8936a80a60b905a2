// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "geometry/camera_model.h"
#include "geometry/rigid_transform.h"

namespace kinemap {

struct PoseObservation {
  Eigen::Vector3d point_in_map;
  Eigen::Vector2d pixel_px;
  double inverse_variance;                                       ///< 1 / px^2
  double right_x_px = std::numeric_limits<double>::quiet_NaN();  ///< column in the right image; not a number: none
  /// How far off the point may be along one direction: one standard deviation, map frame. Zero with a right image.
  Eigen::Vector3d depth_error = Eigen::Vector3d::Zero();
};

struct PoseEstimate {
  RigidTransform camera_from_map;
  std::vector<bool> inlier;  ///< one an observation
  int inliers = 0;
  /// Inverse covariance of a step (translation, rotation vector) in the camera frame, from inliers and prior.
  Matrix6d information = Matrix6d::Zero();
};

/// Where a camera is expected before it sees anything.
struct PosePrior {
  RigidTransform camera_from_map;
  Matrix6d information;  ///< inverse covariance of a step (translation, rotation vector) in the camera frame

  /// Whether a pose is one of the 99.9 % that are nearest to the expected one.
  bool Contains(const RigidTransform& pose) const;
};

/// Pose of one camera against fixed points: Levenberg-Marquardt on the reprojection error with Huber's loss; after
/// each of four rounds observations beyond the 95 % bound of chi-squared (of two degrees of freedom, of three with
/// a right image) are left out (and may come back), and the last
/// two rounds are quadratic (Mur-Artal and Tardos 2015, section V). Errors in the direction in which a point's own
/// uncertainty shows count as much less as that is more than the pixel's: such a point tells of the turn, and of the
/// shift what it knows. A prior pulls like the observations do, and in all
/// rounds: Huber's loss bounds its pull on a camera that did not move as expected.
class PoseOptimizer {
 public:
  explicit PoseOptimizer(const CameraModel& camera) : camera_(camera) {}

  PoseEstimate Optimize(const RigidTransform& initial_camera_from_map, const std::vector<PoseObservation>& observations,
                        const std::optional<PosePrior>& prior = std::nullopt) const;

 private:
  struct NormalEquations;
  NormalEquations Linearize(const RigidTransform& camera_from_map, const std::vector<PoseObservation>& observations,
                            const std::vector<bool>& inlier, bool robust) const;

  void AddPrior(const PosePrior& prior, const RigidTransform& camera_from_map, NormalEquations* equations) const;

  CameraModel camera_;
};

}  // namespace kinemap
