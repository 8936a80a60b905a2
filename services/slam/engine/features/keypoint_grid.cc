// SPDX-License-Identifier: Apache-2.0
#include "features/keypoint_grid.h"

#include <algorithm>
#include <cmath>

namespace kinemap {
KeypointGrid::KeypointGrid(const std::vector<Keypoint>& keypoints, const Eigen::Vector2d& low_corner_px,
                           const Eigen::Vector2d& high_corner_px)
    : low_x_px_(low_corner_px.x()), low_y_px_(low_corner_px.y()) {
  columns_ = std::max(1, static_cast<int>(std::ceil((high_corner_px.x() - low_corner_px.x()) / kCellSizePx)));
  rows_ = std::max(1, static_cast<int>(std::ceil((high_corner_px.y() - low_corner_px.y()) / kCellSizePx)));
  const auto cell_of = [&](const Keypoint& keypoint) {
    return Row(keypoint.pixel_px.y()) * columns_ + Column(keypoint.pixel_px.x());
  };
  cell_start_.assign(columns_ * rows_ + 1, 0);
  for (const Keypoint& keypoint : keypoints) ++cell_start_[cell_of(keypoint) + 1];
  for (size_t cell = 1; cell < cell_start_.size(); ++cell) cell_start_[cell] += cell_start_[cell - 1];
  entries_.resize(keypoints.size());
  std::vector<int> next(cell_start_.begin(), cell_start_.end() - 1);
  for (size_t i = 0; i < keypoints.size(); ++i) {
    const Keypoint& keypoint = keypoints[i];
    entries_[next[cell_of(keypoint)]++] = {static_cast<float>(keypoint.pixel_px.x()),
                                           static_cast<float>(keypoint.pixel_px.y()), keypoint.octave,
                                           static_cast<int>(i)};
  }
}

int KeypointGrid::Column(double x_px) const {
  return static_cast<int>(std::clamp(std::floor((x_px - low_x_px_) / kCellSizePx), 0.0, columns_ - 1.0));
}

int KeypointGrid::Row(double y_px) const {
  return static_cast<int>(std::clamp(std::floor((y_px - low_y_px_) / kCellSizePx), 0.0, rows_ - 1.0));
}

void KeypointGrid::FindNear(const Eigen::Vector2d& center_px, double radius_px, int min_octave, int max_octave,
                            std::vector<int>* found) const {
  found->clear();
  if (entries_.empty()) return;
  const int first_column = Column(center_px.x() - radius_px), last_column = Column(center_px.x() + radius_px);
  const int first_row = Row(center_px.y() - radius_px), last_row = Row(center_px.y() + radius_px);
  for (int row = first_row; row <= last_row; ++row) {
    // The cells of a row lie one after the other, so a row's stretch is one run of entries.
    const int begin = cell_start_[row * columns_ + first_column];
    const int end = cell_start_[row * columns_ + last_column + 1];
    for (int i = begin; i < end; ++i) {
      const Entry& entry = entries_[i];
      if (entry.octave < min_octave || entry.octave > max_octave) continue;
      if (std::abs(entry.x_px - center_px.x()) > radius_px || std::abs(entry.y_px - center_px.y()) > radius_px)
        continue;
      found->push_back(entry.index);
    }
  }
}

}  // namespace kinemap
