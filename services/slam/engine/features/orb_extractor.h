// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <vector>

#include "features/frame_features.h"
#include "features/pyramid_scales.h"
#include "geometry/camera_model.h"

namespace kinemap {

struct OrbOptions {
  int features = 2000;
  int fast_threshold = 20;     ///< grey levels a corner must differ from its circle
  int fast_threshold_low = 7;  ///< used where a cell holds no corner at the threshold above
};

/// Oriented FAST corners with rotated BRIEF descriptors (Rublee et al. 2011), spread evenly over every pyramid level.
class OrbExtractor {
 public:
  OrbExtractor(const OrbOptions& options, const PyramidScales& scales);

  /// `image` is 8-bit grey of the camera's size. Pixels are those of level 0, undistorted; the grid is filled.
  FrameFeaturesPtr Extract(const cv::Mat& image, const CameraModel& camera) const;

 private:
  std::vector<cv::KeyPoint> FindCorners(const cv::Mat& level_image, int count) const;
  float CentroidAngleDeg(const cv::Mat& level_image, const cv::KeyPoint& corner) const;

  OrbOptions options_;
  PyramidScales scales_;
  std::vector<int> features_of_level_;
  std::vector<int> circle_half_widths_;  // of the patch whose centroid gives the angle, one a row
  cv::Ptr<cv::ORB> descriptor_;
};

}  // namespace kinemap
