// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "features/keypoint.h"

namespace kinemap {

/// Finds the keypoints near a pixel without looking at all of them.
class KeypointGrid {
 public:
  KeypointGrid() = default;
  /// The box is that of the undistorted image. Positions are copied.
  KeypointGrid(const std::vector<Keypoint>& keypoints, const Eigen::Vector2d& low_corner_px,
               const Eigen::Vector2d& high_corner_px);

  /// Indices of keypoints within `radius_px` (a square's half side) of `center_px` with min_octave <= octave <=
  /// max_octave, replacing the contents of `found`; order is fixed by cell and then by index.
  void FindNear(const Eigen::Vector2d& center_px, double radius_px, int min_octave, int max_octave,
                std::vector<int>* found) const;

  /// A grid of only the keypoints for which keep(index) is true.
  template <typename Keep>
  KeypointGrid Only(Keep keep) const;

  struct Entry {
    float x_px, y_px;
    int octave, index;
  };

  /// Calls visit(const Entry&) once for every keypoint within `margin_px` of a segment, and for others in the cells
  /// that it passes; the order is fixed by the ends.
  template <typename Visit>
  void VisitAlong(const Eigen::Vector2d& from_px, const Eigen::Vector2d& to_px, double margin_px, Visit visit) const;

 private:
  static constexpr double kCellSizePx = 20;

  void VisitCell(int column, int row, auto& visit) const {
    const int cell = row * columns_ + column;
    for (int i = cell_start_[cell]; i < cell_start_[cell + 1]; ++i) visit(entries_[i]);
  }
  int Column(double x_px) const;
  int Row(double y_px) const;

  int columns_ = 0, rows_ = 0;
  double low_x_px_ = 0, low_y_px_ = 0;
  std::vector<int> cell_start_;  // one a cell and one past the end
  std::vector<Entry> entries_;   // ordered by cell
};

template <typename Keep>
KeypointGrid KeypointGrid::Only(Keep keep) const {
  KeypointGrid kept;
  kept.columns_ = columns_, kept.rows_ = rows_;
  kept.low_x_px_ = low_x_px_, kept.low_y_px_ = low_y_px_;
  kept.cell_start_.reserve(cell_start_.size());
  kept.entries_.reserve(entries_.size());
  size_t cell = 0;
  for (size_t i = 0; i < entries_.size(); ++i) {
    for (; cell < cell_start_.size() && cell_start_[cell] <= static_cast<int>(i); ++cell) {
      kept.cell_start_.push_back(static_cast<int>(kept.entries_.size()));
    }
    if (keep(entries_[i].index)) kept.entries_.push_back(entries_[i]);
  }
  kept.cell_start_.resize(cell_start_.size(), static_cast<int>(kept.entries_.size()));
  return kept;
}

template <typename Visit>
void KeypointGrid::VisitAlong(const Eigen::Vector2d& from_px, const Eigen::Vector2d& to_px, double margin_px,
                              Visit visit) const {
  if (entries_.empty()) return;
  const Eigen::Vector2d low(low_x_px_, low_y_px_), cells(columns_, rows_);
  // Along the axis in which the segment is longer, so that it rises by at most a cell from one line of cells to the
  // next.
  const int along = std::abs(to_px.x() - from_px.x()) >= std::abs(to_px.y() - from_px.y()) ? 0 : 1, across = 1 - along;
  const bool forward = from_px[along] <= to_px[along];
  const Eigen::Vector2d begin = ((forward ? from_px : to_px) - low) / kCellSizePx;
  const Eigen::Vector2d end = ((forward ? to_px : from_px) - low) / kCellSizePx;
  const double margin = margin_px / kCellSizePx, length = end[along] - begin[along];
  const double slope = length > 0 ? (end[across] - begin[across]) / length : 0;
  const int first = static_cast<int>(std::clamp(std::floor(begin[along] - margin), 0.0, cells[along]));
  const int last = static_cast<int>(std::clamp(std::floor(end[along] + margin), -1.0, cells[along] - 1));
  for (int line = first; line <= last; ++line) {
    const double enters = std::clamp<double>(line - margin, begin[along], end[along]) - begin[along];
    const double leaves = std::clamp<double>(line + 1 + margin, begin[along], end[along]) - begin[along];
    const double one = begin[across] + slope * enters, other = begin[across] + slope * leaves;
    const double lowest = std::floor(std::min(one, other) - margin),
                 highest = std::floor(std::max(one, other) + margin);
    const int cell_begin = static_cast<int>(std::clamp(lowest, 0.0, cells[across]));
    const int cell_end = static_cast<int>(std::clamp(highest + 1, 0.0, cells[across]));
    for (int cell = cell_begin; cell < cell_end; ++cell) {
      along == 0 ? VisitCell(line, cell, visit) : VisitCell(cell, line, visit);
    }
  }
}

}  // namespace kinemap
