// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "features/frame_features.h"
#include "geometry/camera_model.h"
#include "storage/byte_reader.h"
#include "storage/byte_writer.h"

namespace kinemap {

/// More keypoints in one image than this are taken for damage.
constexpr uint32_t kMostFeatures = 100000;

void WriteFeatures(const FrameFeatures& features, ByteWriter* writer);

/// The grid is made anew from the camera's image box. Throws MapFileError for what no extractor gives.
FrameFeaturesPtr ReadFeatures(const CameraModel& camera, int pyramid_levels, ByteReader* reader);

}  // namespace kinemap
