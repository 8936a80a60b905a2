// SPDX-License-Identifier: Apache-2.0
#include "features/orb_extractor.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "features/keypoint_distribution.h"

namespace kinemap {
namespace {
constexpr int kBlurSizePx = 7;
constexpr double kBlurSigmaPx = 2;
}  // namespace

OrbExtractor::OrbExtractor(const OrbOptions& options, const PyramidScales& scales)
    : scales_(scales), team_(std::make_unique<ThreadTeam>(options.threads)) {
  for (int level = 0; level < scales.levels(); ++level) levels_.emplace_back(options.thresholds);
  SetWanted(options.features);
}

void OrbExtractor::SetWanted(int features) {
  // Each level gets its share in proportion to its side, not its area: coarse levels carry the distant matches.
  double total = 0;
  for (int level = 0; level < scales_.levels(); ++level) total += 1 / scales_.scale(level);
  for (int level = 0; level < scales_.levels(); ++level) {
    levels_[level].features = static_cast<int>(std::lround(features / scales_.scale(level) / total));
  }
}

void OrbExtractor::FillPyramid(const cv::Mat& image) {
  levels_.front().image = image;
  for (int octave = 1; octave < scales_.levels(); ++octave) {
    const double scale = scales_.scale(octave);
    const cv::Size size(static_cast<int>(std::lround(image.cols / scale)),
                        static_cast<int>(std::lround(image.rows / scale)));
    cv::resize(levels_[octave - 1].image, levels_[octave].image, size, 0, 0, cv::INTER_LINEAR);
  }
}

void OrbExtractor::ExtractLevel(int octave, const CameraModel& camera) {
  Level& level = levels_[octave];
  level.keypoints.clear();
  level.descriptors.clear();
  const std::vector<Corner>& corners = level.detector.Detect(level.image, kBriefReachPx);
  if (corners.empty()) return;
  const cv::Rect area(kBriefReachPx, kBriefReachPx, level.image.cols - 2 * kBriefReachPx,
                      level.image.rows - 2 * kBriefReachPx);
  cv::GaussianBlur(level.image, level.smoothed, {kBlurSizePx, kBlurSizePx}, kBlurSigmaPx, kBlurSigmaPx,
                   cv::BORDER_REFLECT_101);
  const double scale_x = static_cast<double>(levels_.front().image.cols) / level.image.cols;
  const double scale_y = static_cast<double>(levels_.front().image.rows) / level.image.rows;
  for (const Corner& corner : DistributeEvenly(corners, area, level.features)) {
    Keypoint keypoint;
    // Resizing maps pixel centres by (x + 0.5) s - 0.5.
    keypoint.raw_px = {(corner.column + corner.ColumnOffset() + 0.5) * scale_x - 0.5,
                       (corner.row + corner.RowOffset() + 0.5) * scale_y - 0.5};
    if (!camera.CanUndistort(keypoint.raw_px)) continue;
    keypoint.pixel_px = camera.Undistort(keypoint.raw_px);
    keypoint.spread = camera.SpreadAt(keypoint.pixel_px);
    keypoint.angle_deg = orientation_.AngleDeg(level.image, corner.column, corner.row);
    keypoint.octave = octave;
    level.keypoints.push_back(keypoint);
    level.descriptors.push_back(brief_.Compute(level.smoothed, corner.column, corner.row, keypoint.angle_deg));
  }
}

std::shared_ptr<FrameFeatures> OrbExtractor::Extract(const cv::Mat& image, const CameraModel& camera,
                                                     std::vector<cv::Mat>* pyramid) {
  FillPyramid(image);
  if (pyramid != nullptr) {
    for (const Level& level : levels_) pyramid->push_back(level.image);
  }
  team_->Run(scales_.levels(), [&](int octave) { ExtractLevel(octave, camera); });
  auto features = std::make_shared<FrameFeatures>();
  size_t count = 0;
  for (const Level& level : levels_) count += level.keypoints.size();
  features->keypoints.reserve(count);
  features->descriptors.reserve(count);
  for (const Level& level : levels_) {
    features->keypoints.insert(features->keypoints.end(), level.keypoints.begin(), level.keypoints.end());
    features->descriptors.insert(features->descriptors.end(), level.descriptors.begin(), level.descriptors.end());
  }
  features->grid = KeypointGrid(features->keypoints, camera.low_corner_px(), camera.high_corner_px());
  levels_.front().image.release();
  return features;
}

}  // namespace kinemap
