// SPDX-License-Identifier: Apache-2.0
#include "features/rig_extractor.h"

namespace kinemap {

RigExtractor::RigExtractor(const OrbOptions& options, const PyramidScales& scales, const CameraModel& camera)
    : camera_(camera),
      extractor_(options, scales),
      right_extractor_(options, scales),
      team_(options.threads),
      stereo_matcher_(camera, scales),
      depth_reader_(camera) {}

void RigExtractor::SetWanted(int features) {
  extractor_.SetWanted(features);
  right_extractor_.SetWanted(features);
}

FrameFeaturesPtr RigExtractor::Extract(const cv::Mat& image, const cv::Mat& right, const cv::Mat& depth_m) {
  if (right.empty()) {
    const std::shared_ptr<FrameFeatures> features = extractor_.Extract(image, camera_);
    if (!depth_m.empty()) depth_reader_.Read(depth_m, features.get());
    return features;
  }
  StereoView left_view, right_view;
  const std::shared_ptr<FrameFeatures> features = extractor_.Extract(image, camera_, &left_view.pyramid);
  const std::shared_ptr<FrameFeatures> beside = right_extractor_.Extract(right, camera_, &right_view.pyramid);
  left_view.features = features.get();
  right_view.features = beside.get();
  stereo_matcher_.Match(left_view, right_view, &team_);
  if (!depth_m.empty()) depth_reader_.Read(depth_m, features.get());
  return features;
}

}  // namespace kinemap
