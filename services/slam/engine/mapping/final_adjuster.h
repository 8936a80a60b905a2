// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

#include "geometry/camera_model.h"
#include "map/slam_map.h"
#include "optimization/map_bundle.h"

namespace kinemap {

struct FinalAdjusterOptions {
  int keyframes = 1000;  ///< newest, that move
  /// Errors that a local window leaves behind bend the map only little a frame, so the end needs a finer tolerance.
  BundleOptions bundle{60, 20, 1e-9, 0.01};
  /// Part of the cost that what calibration left must explain to be believed. On KITTI it explains more than a
  /// hundredth. Small errors of the features' places, which grow with the distance from the axis too, explain up to a
  /// thousandth of a perfect camera's cost, by a distortion that is not there and bends the map.
  double least_explained = 0.005;
  /// What calibration may have left, in all. More is bent where little but traffic is seen, and no lens.
  double most_radial = 0.05;
};

/// Adjusts a whole map once more, with the camera as it is calibrated or, where that explains the images clearly
/// better, with what calibration left; that always where depths are measured, which keep the map from bending and take
/// their scale from the right image's place.
class FinalAdjuster {
 public:
  FinalAdjuster(const FinalAdjusterOptions& options, const CameraModel& camera) : options_(options), camera_(camera) {}

  /// Returns the radial distortion that was believed (see BundleProblem::radial), by which the features may be moved; 0
  /// for none, and where depths are measured, by which they cannot. `known_radial` was taken out of them before.
  double Adjust(SlamMap* map, double known_radial = 0) const;

  /// The adjusted problem of a whole map, with the distortion that is believed. Once `cancelled` is true it ends early
  /// with one that is good for nothing.
  BundleProblem Solve(BundleProblem problem, double known_radial, const std::atomic<bool>* cancelled = nullptr) const;

  /// Whether a right image or a depth camera tells some of the depths.
  static bool MeasuresDepth(const BundleProblem& problem);

 private:
  FinalAdjusterOptions options_;
  CameraModel camera_;
};

}  // namespace kinemap
