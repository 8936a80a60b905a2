// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "features/frame_features.h"
#include "features/pyramid_scales.h"
#include "features/thread_team.h"
#include "geometry/camera_model.h"

namespace kinemap {

/// One image of a pair with its pyramid, level 0 first.
struct StereoView {
  FrameFeatures* features;
  std::vector<cv::Mat> pyramid;
};

/// Finds the keypoints of the left image in the right one: nearest descriptor along the row, then the best place for
/// the patch between the right image's pixels (sum of absolute differences, parabola), and last what differs from its
/// match far more than others do is dropped (Mur-Artal and Tardos 2017, section III-A).
class StereoMatcher {
 public:
  /// The camera needs a baseline.
  StereoMatcher(const CameraModel& camera, const PyramidScales& scales);

  /// Fills right_x_px and depth_m of the left keypoints that were found. Returns how many.
  int Match(const StereoView& left, const StereoView& right, ThreadTeam* team) const;

 private:
  struct Rows;
  struct Refined;
  Rows RowsOf(const FrameFeatures& right) const;
  int FindCandidate(const FrameFeatures& left, int keypoint, const FrameFeatures& right, const Rows& rows) const;
  bool Refine(const StereoView& left, const StereoView& right, int keypoint, int match, Refined* refined) const;

  CameraModel camera_;
  PyramidScales scales_;
};

}  // namespace kinemap
