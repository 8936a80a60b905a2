// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "features/object_labels.h"

namespace kinemap {

/// What each pixel of an image belongs to, in one byte a pixel.
class PixelLabels {
 public:
  /// One label for all: background.
  PixelLabels() : labels_(1) {}

  /// Arguments as ObjectLabels takes them; nothing of `track_image` is kept. Objects beyond the 254th belong to nobody.
  PixelLabels(Stage stage, const cv::Mat& track_image, const std::vector<ObjectRow>& rows, bool masks_fresh,
              int border_px);

  /// From what `index` and `labels` gave.
  PixelLabels(cv::Mat index, std::vector<FeatureLabel> labels) : index_(std::move(index)), labels_(std::move(labels)) {}

  /// Moves every pixel by a map of cv::remap (CV_16SC2 or CV_32FC1 pair); what comes from outside belongs to nobody.
  void Remap(const cv::Mat& map_x, const cv::Mat& map_y);

  /// Equal indices mean equal labels.
  uint8_t IndexAt(int column, int row) const { return index_.empty() ? 0 : index_.at<uint8_t>(row, column); }
  const FeatureLabel& LabelAt(int column, int row) const { return labels_[IndexAt(column, row)]; }
  const cv::Mat& index() const { return index_; }
  const std::vector<FeatureLabel>& labels() const { return labels_; }

 private:
  cv::Mat index_;                     // CV_8U; empty: background everywhere
  std::vector<FeatureLabel> labels_;  // by index: background, nobody, then the objects
};

/// Whether a pixel may be taken for a view of what another one shows: what moves or belongs to nobody never, an object
/// that is mapped but constrains no pose only as itself.
bool MayMatch(const FeatureLabel& a, const FeatureLabel& b);

}  // namespace kinemap
