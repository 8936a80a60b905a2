// SPDX-License-Identifier: Apache-2.0
#include "semi_dense/view_builder.h"

#include <opencv2/imgproc.hpp>

namespace kinemap {

ViewBuilder::ViewBuilder(const CameraModel& camera) {
  if (!camera.is_distorted()) return;
  map_x_.create(camera.height_px(), camera.width_px(), CV_32F);
  map_y_.create(camera.height_px(), camera.width_px(), CV_32F);
  for (int row = 0; row < map_x_.rows; ++row) {
    for (int column = 0; column < map_x_.cols; ++column) {
      const Eigen::Vector2d raw = camera.Distort({column, row});
      map_x_.at<float>(row, column) = static_cast<float>(raw.x());
      map_y_.at<float>(row, column) = static_cast<float>(raw.y());
    }
  }
}

void ViewBuilder::Complete(KeyframeView* view) const {
  if (!map_x_.empty()) {
    cv::Mat undistorted;
    cv::remap(view->grey, undistorted, map_x_, map_y_, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
    view->grey = undistorted;
    view->labels.Remap(map_x_, map_y_);
  }
  AddGradient(view);
}

void ViewBuilder::AddGradient(KeyframeView* view) {
  cv::Mat parts[2];
  cv::spatialGradient(view->grey, parts[0], parts[1]);
  cv::merge(parts, 2, view->gradient);
}

}  // namespace kinemap
