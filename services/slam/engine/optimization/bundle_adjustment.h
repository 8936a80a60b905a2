// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <limits>
#include <vector>

#include "geometry/camera_model.h"
#include "geometry/rigid_transform.h"
#include "map/ids.h"

namespace kinemap {

struct BundleCamera {
  KeyframeId keyframe_id;
  RigidTransform camera_from_map;
  bool fixed;
};

struct BundlePoint {
  LandmarkId landmark_id;
  Eigen::Vector3d position_in_map;
};

struct BundleObservation {
  int camera;  ///< index
  int point;   ///< index
  Eigen::Vector2d pixel_px;
  double inverse_variance;                                       ///< 1 / px^2
  double right_x_px = std::numeric_limits<double>::quiet_NaN();  ///< column in the right image; not a number: none
  bool outlier = false;
};

/// Three cameras that followed each other.
struct VelocityChange {
  int first, second, third;  ///< indices, in the order of time
  double earlier_s, later_s;
  /// Standard deviation of the change of velocity, part of the speed, were BundleOptions::velocity_change 1.
  double sigma;
};

/// A copy of part of the map, so that it can be solved in another thread.
struct BundleProblem {
  std::vector<BundleCamera> cameras;
  std::vector<BundlePoint> points;
  std::vector<BundleObservation> observations;
  std::vector<VelocityChange> velocity_changes;
  double right_shift_px = 0;  ///< by which the right image's columns are too high
  double radial = 0;          ///< k with pixel = Project(point * (1 + k r^2)), r = distance from the axis at depth 1
  /// Half the sum of Huber's losses and priors when the robust iterations ended; not a number: they failed.
  double robust_cost = 0;
};

struct BundleOptions {
  int robust_iterations = 5;  ///< with Huber's loss, before outliers are left out
  int final_iterations = 5;   ///< quadratic, over the rest
  double tolerance = 1e-5;    ///< ends when an iteration lowers the cost by less than this part of it
  /// Standard deviation of the radial distortion that the calibration may have left in the images; 0 keeps it at 0.
  double radial_sigma = 0;
  /// The same of the columns of the right image, found together with the radial distortion.
  double right_shift_sigma_px = 0.1;
  /// By how much of its top speed the camera's velocity changes in a second, one standard deviation; 0: by anything.
  double velocity_change = 0;
};

/// Minimises the reprojection error over the cameras that are not fixed and all points, in place, and marks the
/// outliers. With `radial_sigma` it also finds what calibration left, by which the right image is shifted (a twelfth of
/// a pixel changes a stereo map's scale by three thousandths) and the radial distortion: a hundredth of it is enough
/// to change a monocular map's scale by a tenth in one turn (for KITTI see Cvisic, Markovic and Petrovic,
/// "Recalibrating the KITTI dataset camera setup for improved odometry accuracy", ECMR 2021). With `velocity_change`
/// one camera's scale is also held by its inertia: by the velocities of cameras that follow each other. Bounded by
/// iterations, never by time, on one thread: the same problem gives the same bytes. Once `cancelled` is true it ends
/// early with a problem that is good for nothing.
void SolveBundle(const CameraModel& camera, const BundleOptions& options, BundleProblem* problem,
                 const std::atomic<bool>* cancelled = nullptr);

/// Its two halves: the robust iterations, after which outliers are marked, and the quadratic ones without them.
void SolveBundleRobustly(const CameraModel& camera, const BundleOptions& options, BundleProblem* problem,
                         const std::atomic<bool>* cancelled = nullptr);
void SolveBundleWithoutOutliers(const CameraModel& camera, const BundleOptions& options, BundleProblem* problem,
                                const std::atomic<bool>* cancelled = nullptr);

}  // namespace kinemap
