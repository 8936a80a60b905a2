// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "features/object_labels.h"
#include "map/ids.h"

namespace kinemap {

struct SemiDensePoint {
  std::array<float, 3> position;  ///< in the keyframe's camera frame and the units of what is anchored there
  float depth_sigma;              ///< standard deviation along the optical axis, same units
  uint8_t grey;
  MotionState state;
  int16_t category;    ///< -1: none
  uint32_t object_id;  ///< 0: background
};

/// What a keyframe shows of the world, finished: seen at the keyframe's time, anchored there for good.
struct SemiDenseCloud {
  KeyframeId keyframe_id = kNoId;
  std::vector<SemiDensePoint> points;  ///< row by row of the image
};

}  // namespace kinemap
