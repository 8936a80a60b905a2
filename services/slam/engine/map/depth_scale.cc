// SPDX-License-Identifier: Apache-2.0
#include "map/depth_scale.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace kinemap {
namespace {
constexpr size_t kLeastSamples = 10;
}

double DepthAt(const cv::Mat& depth_m, const Keypoint& keypoint) {
  const int column = static_cast<int>(std::lround(keypoint.raw_px.x()));
  const int row = static_cast<int>(std::lround(keypoint.raw_px.y()));
  if (column < 0 || row < 0 || column >= depth_m.cols || row >= depth_m.rows) return 0;
  const float depth = depth_m.at<float>(row, column);
  return std::isfinite(depth) && depth > 0 ? depth : 0;
}

double MapUnitsPerMetre(const SlamMap& map, const Frame& frame, const cv::Mat& depth_m) {
  if (depth_m.empty()) return 0;
  std::vector<double> ratios;
  for (int i = 0; i < frame.size(); ++i) {
    const Landmark* landmark = map.FindLandmark(frame.landmark_ids[i]);
    if (landmark == nullptr || !landmark->IsTrackable()) continue;
    const double measured_m = DepthAt(depth_m, frame.features->keypoints[i]);
    const double mapped = (frame.camera_from_map * map.PositionInMap(*landmark)).z();
    if (measured_m > 0 && mapped > 0) ratios.push_back(mapped / measured_m);
  }
  if (ratios.size() < kLeastSamples) return 0;
  std::nth_element(ratios.begin(), ratios.begin() + ratios.size() / 2, ratios.end());
  return ratios[ratios.size() / 2];
}

}  // namespace kinemap
