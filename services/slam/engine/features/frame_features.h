// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "features/descriptor.h"
#include "features/keypoint.h"
#include "features/keypoint_grid.h"
#include "geometry/camera_model.h"

namespace kinemap {

/// All that is kept of an image: never changed after extraction, shared by frame and keyframe.
struct FrameFeatures {
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;  ///< one a keypoint
  KeypointGrid grid;

  int size() const { return static_cast<int>(keypoints.size()); }
};

using FrameFeaturesPtr = std::shared_ptr<const FrameFeatures>;

/// The same features where another model of the lens undistorts them to; of one image without depths.
FrameFeaturesPtr Undistorted(const FrameFeatures& features, const CameraModel& camera);

}  // namespace kinemap
