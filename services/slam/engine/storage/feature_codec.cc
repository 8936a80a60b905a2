// SPDX-License-Identifier: Apache-2.0
#include "storage/feature_codec.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace kinemap {
namespace {

constexpr double kFarthestPx = 1e6;

/// What some of an image's keypoints have beyond the usual.
struct Extras {
  bool raw_px = false;  ///< differs from the undistorted pixel
  bool depth = false;   ///< or the right image's column
};

template <typename Archive>
void Serialize(Archive& archive, Keypoint& keypoint, const Extras& extras) {
  auto& [pixel_px, raw_px, angle_deg, octave, right_x_px, spread, depth_m] = keypoint;
  auto level = static_cast<uint8_t>(octave);
  archive(pixel_px, angle_deg, level);
  octave = level;
  if (extras.depth) archive(right_x_px, depth_m);
  if (extras.raw_px) {
    archive(raw_px, spread);
  } else if constexpr (Archive::kReads) {
    raw_px = pixel_px;
  }
}

bool IsUsable(const Keypoint& keypoint, int pyramid_levels) {
  const double farthest = std::max(keypoint.pixel_px.cwiseAbs().maxCoeff(), keypoint.raw_px.cwiseAbs().maxCoeff());
  return keypoint.pixel_px.allFinite() && keypoint.raw_px.allFinite() && farthest < kFarthestPx &&
         std::isfinite(keypoint.angle_deg) && keypoint.angle_deg >= 0 && keypoint.angle_deg <= 360 &&
         keypoint.octave < pyramid_levels && !std::isinf(keypoint.right_x_px) && std::isfinite(keypoint.depth_m) &&
         keypoint.depth_m >= 0 && std::isfinite(keypoint.spread) && keypoint.spread > 0;
}

}  // namespace

void WriteFeatures(const FrameFeatures& features, ByteWriter* writer) {
  Extras extras;
  for (const Keypoint& keypoint : features.keypoints) {
    extras.raw_px |= keypoint.pixel_px != keypoint.raw_px || keypoint.spread != 1;
    extras.depth |= keypoint.depth_m != 0 || !std::isnan(keypoint.right_x_px);
  }
  (*writer)(static_cast<uint32_t>(features.size()), extras.raw_px, extras.depth);
  for (Keypoint keypoint : features.keypoints) Serialize(*writer, keypoint, extras);
  for (const Descriptor& descriptor : features.descriptors) (*writer)(descriptor);
}

FrameFeaturesPtr ReadFeatures(const CameraModel& camera, int pyramid_levels, ByteReader* reader) {
  uint32_t count = 0;
  Extras extras;
  (*reader)(count, extras.raw_px, extras.depth);
  if (count > kMostFeatures) throw MapFileError("damaged: " + std::to_string(count) + " features of one image");
  auto features = std::make_shared<FrameFeatures>();
  features->keypoints.resize(count);
  features->descriptors.resize(count);
  for (Keypoint& keypoint : features->keypoints) {
    Serialize(*reader, keypoint, extras);
    if (!IsUsable(keypoint, pyramid_levels)) throw MapFileError("damaged: a keypoint outside of every image");
  }
  for (Descriptor& descriptor : features->descriptors) (*reader)(descriptor);
  features->grid = KeypointGrid(features->keypoints, camera.low_corner_px(), camera.high_corner_px());
  return features;
}

}  // namespace kinemap
