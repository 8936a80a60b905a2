// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
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

 private:
  struct Entry {
    float x_px, y_px;
    int octave, index;
  };
  int Column(double x_px) const;
  int Row(double y_px) const;

  int columns_ = 0, rows_ = 0;
  double low_x_px_ = 0, low_y_px_ = 0;
  std::vector<int> cell_start_;  // one a cell and one past the end
  std::vector<Entry> entries_;   // ordered by cell
};

}  // namespace kinemap
