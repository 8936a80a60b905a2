// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "features/object_labels.h"

namespace kinemap {

/// What a caller may choose. The thresholds of each step are in that step's own options.
struct EngineOptions {
  Stage stage = Stage::kMoving;  ///< which objects' features stay out of tracking
  int features = 2000;           ///< ORB features wanted a frame
  int pyramid_levels = 8;
  double pyramid_factor = 1.2;      ///< size ratio of neighbouring levels
  int fast_threshold = 20;          ///< grey levels; corner detection
  int fast_threshold_low = 7;       ///< where nothing is found at fast_threshold
  int mask_border_px = 3;           ///< features this close to an object's outline belong to nobody
  uint64_t seed = 0;                ///< of all random numbers, with the frame's timestamp
  int merge_delay_frames = 2;       ///< bundle adjustment of keyframe k is merged at frame k + this, at least 1
  int local_bundle_keyframes = 15;  ///< keyframes that move in a local bundle adjustment
  double radial_sigma = 0.01;  ///< distortion calibration may have left, found in young maps; 0: calibration is exact
  double velocity_change = 0.05;       ///< of one camera in a second, sigma, part of its top speed; 0: by anything
  int threads = 2;                     ///< of feature extraction; results are the same with any number
  bool loop_closing = true;            ///< recognises places seen before; needs a vocabulary
  double right_shift_sigma_px = 0.05;  ///< the same of the right image's columns, found with the distortion
  double depth_baseline_m = 0.5;       ///< of the pair (1 px) that a depth camera without a right image is as good as
  bool wait_for_loops = true;          ///< false: a loop is merged when it is solved, not at a fixed frame (realtime)
  int opencv_threads = 1;              ///< for the whole process; 0 leaves OpenCV as it is
  bool semi_dense = false;             ///< inverse depths of every keyframe's gradient pixels, in the background
  int64_t map_id = 0;                  ///< ids start at map_id << 32; 0 <= map_id < 2^31
  std::string vocabulary_path;         ///< of the places' words; empty: no place is recognised but by its looks nearby
  double camera_height_m = 0;   ///< of the camera above the road, with one camera; 0: unknown, scale stays arbitrary
  int new_map_after_lost = 50;  ///< lost frames after which another map is begun; the old one is kept
  bool localize_only = false;   ///< only finds the camera in the loaded maps, which stay as they are
  Eigen::Matrix4d map_from_first_camera = Eigen::Matrix4d::Identity();  ///< pose of the first keyframe

  /// Throws std::invalid_argument that names the option and its value.
  void Check() const;
};

}  // namespace kinemap
