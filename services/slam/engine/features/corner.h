// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kinemap {

/// A corner on one pyramid level.
struct Corner {
  int column, row;                  ///< the pixel whose score is largest
  int score;                        ///< grey levels by which nine neighbours in a row differ from it
  float column_offset, row_offset;  ///< from the pixel to the top of the scores around it, at most half a pixel
};

}  // namespace kinemap
