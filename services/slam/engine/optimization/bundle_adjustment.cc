// SPDX-License-Identifier: Apache-2.0
#include "optimization/bundle_adjustment.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "optimization/bundle_equations.h"
#include "optimization/radial_projection.h"

namespace kinemap {
namespace {

constexpr double kFirstRadius = 1e4;
constexpr double kLeastRadius = 1e-32;
constexpr double kLeastGain = 1e-3;

/// One round of minimisation over all observations that are no outliers, by Levenberg's and Marquardt's method with
/// Nielsen's update of the damping (Madsen, Nielsen and Tingleff, "Methods for non-linear least squares problems",
/// 2004, section 3.2). Returns the cost at its end; not a number: there was none to begin with.
double Minimize(const CameraModel& camera, const BundleOptions& options, bool robust, BundleProblem* problem,
                const std::atomic<bool>* cancelled) {
  BundleEquations equations(camera, options, robust, *problem);
  if (!equations.HasUnknownCameras()) return 0;
  BundleState state(*problem);
  double cost = equations.Linearize(state);
  if (!std::isfinite(cost)) return std::nan("");
  double radius = kFirstRadius, shrink = 2;
  BundleStep step;
  const int iterations = robust ? options.robust_iterations : options.final_iterations;
  for (int i = 0; i < iterations && radius > kLeastRadius; ++i) {
    if (cancelled != nullptr && *cancelled) break;
    double gain = 0;
    if (equations.Solve(1 / radius, &step)) {
      BundleState moved = equations.Moved(state, step);
      const double moved_cost = equations.Cost(moved), decrease = cost - moved_cost;
      gain = decrease / step.expected_decrease;
      if (gain > kLeastGain) state = std::move(moved);
      if (std::abs(decrease) <= options.tolerance * cost) {
        cost = std::min(cost, moved_cost);
        break;
      }
    }
    if (gain > kLeastGain) {
      radius /= std::max(1.0 / 3, 1 - std::pow(2 * gain - 1, 3));
      shrink = 2;
      cost = equations.Linearize(state);
    } else {
      radius /= shrink;
      shrink *= 2;
    }
  }
  state.WriteTo(problem);
  return cost;
}

/// A point behind a camera that sees it has an error without bound, which would drown all others.
void LeaveOutWhatIsBehind(BundleProblem* bundle) {
  for (BundleObservation& observation : bundle->observations) {
    const Eigen::Vector3d point =
        bundle->cameras[observation.camera].camera_from_map * bundle->points[observation.point].position_in_map;
    observation.outlier = point.z() <= 0;
  }
}

void MarkOutliers(const CameraModel& camera, BundleProblem* bundle) {
  for (BundleObservation& observation : bundle->observations) {
    const Eigen::Vector3d point =
        bundle->cameras[observation.camera].camera_from_map * bundle->points[observation.point].position_in_map;
    const bool stereo = !std::isnan(observation.right_x_px);
    double squared_px = (ProjectRadial(camera, bundle->radial, point) - observation.pixel_px).squaredNorm();
    if (stereo) {
      const double right_x_px = RightXRadial(camera, bundle->radial, point) + bundle->right_shift_px;
      squared_px += std::pow(right_x_px - observation.right_x_px, 2);
    }
    const double bound = stereo ? kOutlierBound<3> : kOutlierBound<2>;
    observation.outlier = point.z() <= 0 || !(squared_px * observation.inverse_variance <= bound);
  }
}

}  // namespace

void SolveBundle(const CameraModel& camera, const BundleOptions& options, BundleProblem* problem,
                 const std::atomic<bool>* cancelled) {
  SolveBundleRobustly(camera, options, problem, cancelled);
  SolveBundleWithoutOutliers(camera, options, problem, cancelled);
}

void SolveBundleRobustly(const CameraModel& camera, const BundleOptions& options, BundleProblem* problem,
                         const std::atomic<bool>* cancelled) {
  LeaveOutWhatIsBehind(problem);
  problem->robust_cost = Minimize(camera, options, true, problem, cancelled);
  MarkOutliers(camera, problem);
}

void SolveBundleWithoutOutliers(const CameraModel& camera, const BundleOptions& options, BundleProblem* problem,
                                const std::atomic<bool>* cancelled) {
  if (options.final_iterations == 0) return;
  Minimize(camera, options, false, problem, cancelled);
  MarkOutliers(camera, problem);
}

}  // namespace kinemap
