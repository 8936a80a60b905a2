// SPDX-License-Identifier: Apache-2.0
#include "features/depth_reader.h"

#include <cmath>

namespace kinemap {
namespace {
constexpr double kLargestBendPx = 1.0;
}

double DepthReader::DisparityAt(const cv::Mat& depth_m, int column, int row) const {
  if (column < 0 || row < 0 || column >= depth_m.cols || row >= depth_m.rows) return 0;
  const float depth = depth_m.at<float>(row, column);
  return std::isfinite(depth) && depth > 0 ? camera_.fx_px() * camera_.baseline_m() / depth : 0;
}

double DepthReader::DepthAt(const cv::Mat& depth_m, const Eigen::Vector2d& raw_px) const {
  const int column = static_cast<int>(std::lround(raw_px.x())), row = static_cast<int>(std::lround(raw_px.y()));
  const double center = DisparityAt(depth_m, column, row);
  if (center <= 0) return 0;
  // On a plane disparity is linear in the pixel, however steeply it is seen; across an outline it is not.
  constexpr int kDirections[4][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}};
  for (const auto& [dx, dy] : kDirections) {
    const double before = DisparityAt(depth_m, column - dx, row - dy);
    const double after = DisparityAt(depth_m, column + dx, row + dy);
    if (before <= 0 || after <= 0) continue;
    if (std::abs(before - 2 * center + after) > kLargestBendPx) return 0;
  }
  return camera_.DepthOfDisparity(center);
}

int DepthReader::Read(const cv::Mat& depth_m, FrameFeatures* features) const {
  int known = 0;
  for (Keypoint& keypoint : features->keypoints) {
    if (keypoint.HasDepth()) continue;
    const double depth = DepthAt(depth_m, keypoint.raw_px);
    if (depth <= 0) continue;
    keypoint.depth_m = depth;
    keypoint.right_x_px = camera_.RightXAtDepth(keypoint.pixel_px.x(), depth);
    ++known;
  }
  return known;
}

}  // namespace kinemap
