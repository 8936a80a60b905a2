// SPDX-License-Identifier: Apache-2.0
#include "ground/road_view.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace kinemap {
namespace {

constexpr double kHalvedAboveFocalPx = 500;
constexpr double kTopSlope = 0.07;  // of the first row below the optical axis: about 14 camera heights ahead
constexpr double kMostSlope = 0.8;  // of the last row, where a lens sees that far down
constexpr double kMostSideSlope = 1.0;
constexpr int kNormalizedOverPx = 21;
constexpr double kNoiseGrey = 3;  // texture weaker than this is noise
constexpr int kObjectBorderPx = 5;

}  // namespace

RoadViewer::RoadViewer(const CameraModel& camera)
    : halved_(camera.fx_px() > kHalvedAboveFocalPx), focal_px_(halved_ ? camera.fx_px() / 2 : camera.fx_px()) {
  const double left = std::max((camera.low_corner_px().x() - camera.cx_px()) / camera.fx_px(), -kMostSideSlope);
  const double right = std::min((camera.high_corner_px().x() - camera.cx_px()) / camera.fx_px(), kMostSideSlope);
  const double bottom = std::min((camera.high_corner_px().y() - camera.cy_px()) / camera.fy_px(), kMostSlope);
  const int width = std::max(1, static_cast<int>((right - left) * focal_px_));
  const int height = std::max(1, static_cast<int>((bottom - kTopSlope) * focal_px_));
  cx_px_ = -left * focal_px_;
  cy_px_ = -kTopSlope * focal_px_;
  map_.create(height, width, CV_32FC2);
  object_map_.create(height, width, CV_32FC2);
  inside_.create(height, width, CV_8U);
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const Eigen::Vector2d raw = camera.Distort(camera.Project(Ray(column, row)));
      const Eigen::Vector2d read = halved_ ? Eigen::Vector2d((raw.array() - 0.5) / 2) : raw;
      map_.at<cv::Vec2f>(row, column) = {static_cast<float>(read.x()), static_cast<float>(read.y())};
      object_map_.at<cv::Vec2f>(row, column) = {static_cast<float>(raw.x()), static_cast<float>(raw.y())};
      const bool inside =
          raw.x() >= 1 && raw.y() >= 1 && raw.x() < camera.width_px() - 2 && raw.y() < camera.height_px() - 2;
      inside_.at<uint8_t>(row, column) = inside ? 255 : 0;
    }
  }
}

RoadView RoadViewer::Make(const cv::Mat& image) const {
  cv::Mat read = image;
  if (halved_) cv::resize(image, read, {image.cols / 2, image.rows / 2}, 0, 0, cv::INTER_AREA);
  cv::Mat view, grey, mean, square_mean;
  cv::remap(read, view, map_, {}, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  view.convertTo(grey, CV_32F);
  const cv::Size window(kNormalizedOverPx, kNormalizedOverPx);
  cv::blur(grey, mean, window);
  cv::sqrBoxFilter(grey, square_mean, CV_32F, window);
  RoadView road;
  road.intensity.create(grey.size(), CV_32F);
  for (int row = 0; row < grey.rows; ++row) {
    for (int column = 0; column < grey.cols; ++column) {
      const float average = mean.at<float>(row, column);
      const float variance = std::max(0.0f, square_mean.at<float>(row, column) - average * average);
      road.intensity.at<float>(row, column) =
          (grey.at<float>(row, column) - average) / std::sqrt(variance + static_cast<float>(kNoiseGrey * kNoiseGrey));
    }
  }
  road.usable = inside_;
  return road;
}

void RoadViewer::LeaveOutObjects(const cv::Mat& track_image, RoadView* view) const {
  cv::Mat objects = track_image != 0, seen;
  cv::remap(objects, seen, object_map_, {}, cv::INTER_NEAREST, cv::BORDER_REPLICATE);
  const int side = 2 * kObjectBorderPx + 1;
  cv::dilate(seen, seen, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  cv::Mat usable;  // another one: `inside_` is shared by all views
  cv::bitwise_and(inside_, ~seen, usable);
  view->usable = usable;
}

}  // namespace kinemap
