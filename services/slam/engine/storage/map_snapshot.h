// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "geometry/camera_model.h"
#include "map/atlas.h"
#include "storage/map_codec.h"
#include "storage/section_file.h"

namespace kinemap {

/// All maps of an atlas as they were at one moment, on their way into a file. Taking it copies everything but the
/// keyframes' features, which nobody changes; turning it into bytes is the longer part and may be done in any thread.
class MapSnapshot {
 public:
  MapSnapshot(const Atlas& atlas, const CameraModel& camera);

  /// Puts something else into the file.
  void Add(const std::string& section, std::vector<uint8_t> bytes) { sections_[section] = std::move(bytes); }

  std::vector<uint8_t> Bytes() const;

 private:
  Sections sections_;
  FeaturesByKeyframe features_;
};

/// Puts a file's maps into an empty atlas; the active one is active again. Returns the file's sections. Throws
/// MapFileError for bytes that are no map, contradict themselves or come from another camera or pyramid.
Sections ReadMaps(const std::vector<uint8_t>& bytes, const CameraModel& camera, Atlas* atlas);

/// The distortion beyond the calibrated one by which a file's features were undistorted (see CameraModel); 0 in files
/// that do not tell. Throws MapFileError.
double RemainingRadial(const Sections& sections);

}  // namespace kinemap
