// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "geometry/rigid_transform.h"
#include "ground/ground_plane.h"
#include "ground/road_view.h"

namespace kinemap {

struct RoadAlignmentOptions {
  double far_slope = 0.085;       ///< road between the image's bottom and 1 / this camera heights ahead is used,
  double half_width = 1.4;        ///< as far to either side, in camera heights
  double tilt_sigma_rad = 0.012;  ///< how far the road's tilt against the expected normal strays
  int min_pixels = 600;
  double min_correlation = 0.55;  ///< of the road in the two views, once aligned
  double max_sigma = 0.08;        ///< of the logarithm of the height
  int iterations = 12;
};

/// A road plane and how sure it is.
struct RoadMeasurement {
  GroundPlane plane;
  double sigma = 0;  ///< standard deviation of the logarithm of the height
  double correlation = 0;
  int pixels = 0;
};

/// The plane of the road by aligning it directly in two views of known motion: its homography is R + t n^T / h, so
/// n / h is all there is to find (Song and Chandraker, "Robust scale estimation in real-time monocular SFM for
/// autonomous driving", CVPR 2014, dense stereo cue; here with the normal, by Gauss-Newton with a robust weight).
class RoadAlignment {
 public:
  RoadAlignment(const RoadAlignmentOptions& options, const RoadViewer& viewer) : options_(options), viewer_(viewer) {}

  /// Plane in the newer camera's frame, in the units of `older_from_newer`. Searches heights within `low` to `high`
  /// around the expected normal. Nothing when the road shows too little, or differs between the views.
  std::optional<RoadMeasurement> Align(const RoadView& newer, const RoadView& older,
                                       const RigidTransform& older_from_newer, const Eigen::Vector3d& expected_normal,
                                       double low, double high) const;

 private:
  struct Pixel {
    Eigen::Vector3d ray;
    float intensity;
  };

  std::vector<Pixel> RoadPixels(const RoadView& view, const Eigen::Vector3d& normal) const;
  double Correlation(const std::vector<Pixel>& pixels, size_t step, const RoadView& older,
                     const RigidTransform& older_from_newer, const Eigen::Vector3d& normal_by_height) const;

  RoadAlignmentOptions options_;
  const RoadViewer& viewer_;
};

}  // namespace kinemap
