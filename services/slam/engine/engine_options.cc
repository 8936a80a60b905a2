// SPDX-License-Identifier: Apache-2.0
#include "engine_options.h"

#include <sstream>
#include <stdexcept>

#include "geometry/rigid_transform.h"

namespace kinemap {
namespace {

void Require(bool holds, const char* name, const char* expected, double value) {
  if (holds) return;
  std::ostringstream message;
  message << "engine option " << name << ": expected " << expected << ", got " << value;
  throw std::invalid_argument(message.str());
}

}  // namespace

void EngineOptions::Check() const {
  Require(features >= 100 && features <= 20000, "features", "100 to 20000", features);
  Require(pyramid_levels >= 1 && pyramid_levels <= 16, "pyramid_levels", "1 to 16", pyramid_levels);
  Require(pyramid_factor > 1 && pyramid_factor <= 2, "pyramid_factor", "above 1, at most 2", pyramid_factor);
  Require(fast_threshold >= 1 && fast_threshold <= 255, "fast_threshold", "1 to 255", fast_threshold);
  Require(fast_threshold_low >= 1 && fast_threshold_low <= fast_threshold, "fast_threshold_low", "1 to fast_threshold",
          fast_threshold_low);
  Require(mask_border_px >= 0 && mask_border_px <= 50, "mask_border_px", "0 to 50", mask_border_px);
  Require(merge_delay_frames >= 1 && merge_delay_frames <= 1000, "merge_delay_frames", "1 to 1000", merge_delay_frames);
  Require(local_bundle_keyframes >= 2, "local_bundle_keyframes", "at least 2", local_bundle_keyframes);
  Require(radial_sigma >= 0 && radial_sigma <= 1, "radial_sigma", "0 to 1", radial_sigma);
  Require(velocity_change >= 0 && velocity_change <= 100, "velocity_change", "0 to 100", velocity_change);
  Require(threads >= 1 && threads <= 64, "threads", "1 to 64", threads);
  Require(right_shift_sigma_px >= 0 && right_shift_sigma_px <= 10, "right_shift_sigma_px", "0 to 10",
          right_shift_sigma_px);
  Require(depth_baseline_m > 0 && depth_baseline_m <= 100, "depth_baseline_m", "above 0, at most 100",
          depth_baseline_m);
  Require(camera_height_m >= 0 && camera_height_m <= 100, "camera_height_m", "0 to 100", camera_height_m);
  Require(new_map_after_lost >= 1, "new_map_after_lost", "at least 1", new_map_after_lost);
  Require(opencv_threads >= 0 && opencv_threads <= 64, "opencv_threads", "0 to 64", opencv_threads);
  Require(map_id >= 0 && map_id < (int64_t{1} << 31), "map_id", "0 to 2^31 - 1", static_cast<double>(map_id));
  RigidTransform::FromMatrix(map_from_first_camera);
}

}  // namespace kinemap
