// SPDX-License-Identifier: Apache-2.0
#include "features/orb_extractor.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>

#include "features/keypoint_distribution.h"

namespace kinemap {
namespace {

constexpr int kPatchRadiusPx = 15;
constexpr int kEdgePx = 19;  // the rotated descriptor pattern reaches this far
constexpr int kCellPx = 35;
constexpr int kFastRadiusPx = 3;

}  // namespace

OrbExtractor::OrbExtractor(const OrbOptions& options, const PyramidScales& scales)
    : options_(options), scales_(scales) {
  // Each level gets its share in proportion to its side, not its area: coarse levels carry the distant matches.
  double total = 0;
  for (int level = 0; level < scales.levels(); ++level) total += 1 / scales.scale(level);
  for (int level = 0; level < scales.levels(); ++level) {
    features_of_level_.push_back(static_cast<int>(std::lround(options.features / scales.scale(level) / total)));
  }
  for (int row = 0; row <= kPatchRadiusPx; ++row) {
    circle_half_widths_.push_back(
        static_cast<int>(std::lround(std::sqrt(kPatchRadiusPx * kPatchRadiusPx - row * row))));
  }
  descriptor_ = cv::ORB::create(options.features, 1.2f, 1, kEdgePx);
}

std::vector<cv::KeyPoint> OrbExtractor::FindCorners(const cv::Mat& level_image, int count) const {
  const int border = kEdgePx - kFastRadiusPx;
  const cv::Size area(level_image.cols - 2 * border, level_image.rows - 2 * border);
  if (area.width <= 2 * kFastRadiusPx + 1 || area.height <= 2 * kFastRadiusPx + 1) return {};
  const cv::Mat inner = level_image(cv::Rect(cv::Point(border, border), area));
  std::vector<cv::KeyPoint> corners;
  cv::FAST(inner, corners, options_.fast_threshold, true);

  const int columns = (area.width + kCellPx - 1) / kCellPx, rows = (area.height + kCellPx - 1) / kCellPx;
  std::vector<bool> occupied(columns * rows, false);
  for (const cv::KeyPoint& corner : corners) {
    occupied[static_cast<int>(corner.pt.y) / kCellPx * columns + static_cast<int>(corner.pt.x) / kCellPx] = true;
  }
  std::vector<cv::KeyPoint> faint;
  for (int cell = 0; cell < columns * rows; ++cell) {
    if (occupied[cell]) continue;
    const cv::Rect core(cell % columns * kCellPx, cell / columns * kCellPx, kCellPx, kCellPx);
    const cv::Rect padded = cv::Rect(core.x - kFastRadiusPx, core.y - kFastRadiusPx, kCellPx + 2 * kFastRadiusPx,
                                     kCellPx + 2 * kFastRadiusPx) &
                            cv::Rect(cv::Point(0, 0), area);
    if (padded.width <= 2 * kFastRadiusPx || padded.height <= 2 * kFastRadiusPx) continue;
    cv::FAST(inner(padded), faint, options_.fast_threshold_low, true);
    for (cv::KeyPoint& corner : faint) {
      corner.pt += cv::Point2f(static_cast<float>(padded.x), static_cast<float>(padded.y));
      corners.push_back(corner);
    }
  }
  std::vector<cv::KeyPoint> chosen = DistributeEvenly(corners, area, count);
  for (cv::KeyPoint& corner : chosen) corner.pt += cv::Point2f(static_cast<float>(border), static_cast<float>(border));
  return chosen;
}

float OrbExtractor::CentroidAngleDeg(const cv::Mat& level_image, const cv::KeyPoint& corner) const {
  const int stride = static_cast<int>(level_image.step);
  const uint8_t* center = level_image.ptr<uint8_t>(static_cast<int>(corner.pt.y)) + static_cast<int>(corner.pt.x);
  int moment_x = 0, moment_y = 0;
  for (int x = -kPatchRadiusPx; x <= kPatchRadiusPx; ++x) moment_x += x * center[x];
  for (int row = 1; row <= kPatchRadiusPx; ++row) {
    const uint8_t* below = center + row * stride;
    const uint8_t* above = center - row * stride;
    int row_difference = 0;
    for (int x = -circle_half_widths_[row]; x <= circle_half_widths_[row]; ++x) {
      moment_x += x * (below[x] + above[x]);
      row_difference += below[x] - above[x];
    }
    moment_y += row * row_difference;
  }
  return cv::fastAtan2(static_cast<float>(moment_y), static_cast<float>(moment_x));
}

FrameFeaturesPtr OrbExtractor::Extract(const cv::Mat& image, const CameraModel& camera) const {
  auto features = std::make_shared<FrameFeatures>();
  cv::Mat level_image = image;
  for (int level = 0; level < scales_.levels(); ++level) {
    const double scale = scales_.scale(level);
    if (level > 0) {
      const cv::Size size(static_cast<int>(std::lround(image.cols / scale)),
                          static_cast<int>(std::lround(image.rows / scale)));
      cv::Mat smaller;
      cv::resize(level_image, smaller, size, 0, 0, cv::INTER_LINEAR);
      level_image = smaller;
    }
    std::vector<cv::KeyPoint> corners = FindCorners(level_image, features_of_level_[level]);
    if (corners.empty()) continue;
    for (cv::KeyPoint& corner : corners) {
      corner.angle = CentroidAngleDeg(level_image, corner);
      corner.octave = 0;
    }
    cv::Mat descriptors;
    descriptor_->compute(level_image, corners, descriptors);
    const double scale_x = static_cast<double>(image.cols) / level_image.cols;
    const double scale_y = static_cast<double>(image.rows) / level_image.rows;
    for (size_t i = 0; i < corners.size(); ++i) {
      Keypoint keypoint;
      // Resizing maps pixel centres by (x + 0.5) s - 0.5.
      keypoint.raw_px = {(corners[i].pt.x + 0.5) * scale_x - 0.5, (corners[i].pt.y + 0.5) * scale_y - 0.5};
      keypoint.pixel_px = camera.Undistort(keypoint.raw_px);
      keypoint.angle_deg = corners[i].angle;
      keypoint.octave = level;
      features->keypoints.push_back(keypoint);
      Descriptor descriptor;
      std::memcpy(descriptor.data(), descriptors.ptr(static_cast<int>(i)), sizeof(descriptor));
      features->descriptors.push_back(descriptor);
    }
  }
  features->grid = KeypointGrid(features->keypoints, camera.low_corner_px(), camera.high_corner_px());
  return features;
}

}  // namespace kinemap
