// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kinemap {

/// A corner on one pyramid level: the pixel with the largest score (FastScoresOfRow) around it.
struct Corner {
  int16_t column, row;
  uint8_t score;
  uint8_t left, right, above, below;  ///< the neighbours' scores

  /// From the pixel to the top of the parabola through the scores; at most half a pixel.
  float ColumnOffset() const { return ParabolaTop(left, score, right); }
  float RowOffset() const { return ParabolaTop(above, score, below); }

 private:
  static float ParabolaTop(int before, int middle, int after) {
    const int curvature = 2 * middle - before - after;
    return curvature > 0 ? 0.5f * static_cast<float>(after - before) / static_cast<float>(curvature) : 0.0f;
  }
};

}  // namespace kinemap
