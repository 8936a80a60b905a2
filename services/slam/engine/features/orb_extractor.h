// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "features/corner_detector.h"
#include "features/frame_features.h"
#include "features/patch_orientation.h"
#include "features/pyramid_scales.h"
#include "features/steered_brief.h"
#include "features/thread_team.h"
#include "geometry/camera_model.h"

namespace kinemap {

struct OrbOptions {
  int features = 2000;
  CornerThresholds thresholds;
  int threads = 1;  ///< the caller's included; results are the same with any number
};

/// Oriented FAST corners with rotated BRIEF descriptors (Rublee et al. 2011), spread evenly over every pyramid level.
/// Keeps its buffers from image to image; not to be used by two threads at once.
class OrbExtractor {
 public:
  OrbExtractor(const OrbOptions& options, const PyramidScales& scales);

  /// Features wanted of the images from now on.
  void SetWanted(int features);

  /// `image` is 8-bit grey of the camera's size. Pixels are those of level 0, undistorted; the grid is filled.
  /// `pyramid`, where given, gets the image of every level; they last until the next call.
  std::shared_ptr<FrameFeatures> Extract(const cv::Mat& image, const CameraModel& camera,
                                         std::vector<cv::Mat>* pyramid = nullptr);

 private:
  struct Level {
    explicit Level(const CornerThresholds& thresholds) : detector(thresholds) {}
    int features = 0;
    cv::Mat image, smoothed;
    CornerDetector detector;
    std::vector<Keypoint> keypoints;
    std::vector<Descriptor> descriptors;
  };
  void FillPyramid(const cv::Mat& image);
  void ExtractLevel(int octave, const CameraModel& camera);

  PyramidScales scales_;
  PatchOrientation orientation_;
  SteeredBrief brief_;
  std::vector<Level> levels_;
  std::unique_ptr<ThreadTeam> team_;
};

}  // namespace kinemap
