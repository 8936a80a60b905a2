// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <vector>

#include "semi_dense/inverse_depth.h"
#include "semi_dense/keyframe_view.h"
#include "semi_dense/semi_dense_cloud.h"

namespace kinemap {

/// A keyframe of the window without what its image alone tells.
struct OpenKeyframe {
  KeyframeView view;  ///< undistorted; without its gradient
  bool estimated = false;
  std::vector<InverseDepth> estimates;  ///< one a gradient pixel, in their order
  bool finished = false;
};

/// What the semi-dense mapper carries from one keyframe to the next while nothing is under way.
struct SemiDenseState {
  std::deque<KeyframeId> keyframes;
  std::deque<OpenKeyframe> window;
  std::vector<SemiDenseCloud> finished;  ///< and not taken yet
};

}  // namespace kinemap
