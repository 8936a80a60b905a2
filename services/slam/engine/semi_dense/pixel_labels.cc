// SPDX-License-Identifier: Apache-2.0
#include "semi_dense/pixel_labels.h"

#include <map>
#include <opencv2/imgproc.hpp>

namespace kinemap {
namespace {
constexpr uint8_t kNobody = 1;
constexpr size_t kMostLabels = 256;
}  // namespace

PixelLabels::PixelLabels(Stage stage, const cv::Mat& track_image, const std::vector<ObjectRow>& rows, bool masks_fresh,
                         int border_px)
    : labels_(2) {
  labels_[kNobody].role = FeatureRole::kIgnored;
  if (stage == Stage::kBase || track_image.empty()) return;
  const ObjectLabels objects(stage, track_image, rows, masks_fresh, border_px, PyramidScales(1, 1.2));
  std::map<uint32_t, uint8_t> index_of_object{{0, 0}};
  index_.create(track_image.size(), CV_8U);
  uint32_t last_object = 0;
  uint8_t last_index = 0;
  for (int row = 0; row < track_image.rows; ++row) {
    for (int column = 0; column < track_image.cols; ++column) {
      const auto object = static_cast<uint32_t>(track_image.at<int32_t>(row, column));
      if (object != last_object) {
        last_object = object;
        const auto [entry, is_new] = index_of_object.try_emplace(object, kNobody);
        if (is_new && labels_.size() < kMostLabels) {
          entry->second = static_cast<uint8_t>(labels_.size());
          labels_.push_back(objects.LabelOfObject(object));
        }
        last_index = entry->second;
      }
      index_.at<uint8_t>(row, column) = last_index;
    }
  }
  if (border_px == 0) return;
  const cv::Mat window = cv::Mat::ones(2 * border_px + 1, 2 * border_px + 1, CV_8U);
  cv::Mat lowest, highest;
  cv::erode(index_, lowest, window);
  cv::dilate(index_, highest, window);
  index_.setTo(kNobody, lowest != highest);
}

void PixelLabels::Remap(const cv::Mat& map_x, const cv::Mat& map_y) {
  if (index_.empty()) return;
  cv::Mat moved;
  cv::remap(index_, moved, map_x, map_y, cv::INTER_NEAREST, cv::BORDER_CONSTANT, cv::Scalar(kNobody));
  index_ = moved;
}

bool MayMatch(const FeatureLabel& a, const FeatureLabel& b) {
  if (a.role != b.role) return false;
  return a.role == FeatureRole::kTracked || (a.role == FeatureRole::kMapped && a.object_id == b.object_id);
}

}  // namespace kinemap
