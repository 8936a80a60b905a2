// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "features/depth_reader.h"
#include "features/orb_extractor.h"
#include "features/stereo_matcher.h"

namespace kinemap {

/// Features of everything that was taken at one time: the image's, with the depths that the right image and the depth
/// image give them.
class RigExtractor {
 public:
  /// The camera needs a baseline to use a right image or a depth image.
  RigExtractor(const OrbOptions& options, const PyramidScales& scales, const CameraModel& camera);

  /// Features wanted of each image from now on.
  void SetWanted(int features);

  /// Where images of one camera without depths are undistorted by from now on.
  void SetRemainingRadial(double radial) { camera_ = camera_.WithRemainingRadial(radial); }

  /// 8-bit grey images of the camera's size; `right` and `depth_m` (CV_32F, metres, 0 or not a number where unknown)
  /// may be empty. Depth is read where stereo found none.
  FrameFeaturesPtr Extract(const cv::Mat& image, const cv::Mat& right, const cv::Mat& depth_m);

 private:
  CameraModel camera_;
  OrbExtractor extractor_, right_extractor_;  // each keeps its image's pyramid
  ThreadTeam team_;
  StereoMatcher stereo_matcher_;
  DepthReader depth_reader_;
};

}  // namespace kinemap
