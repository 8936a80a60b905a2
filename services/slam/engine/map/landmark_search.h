// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "features/frame_features.h"
#include "features/pyramid_scales.h"
#include "geometry/camera_model.h"
#include "geometry/rigid_transform.h"
#include "map/landmark.h"

namespace kinemap {

/// Where and how large a landmark should appear.
struct LandmarkView {
  Eigen::Vector2d pixel_px;
  int octave;
  double view_cosine;  ///< between the line of sight and the mean direction it was seen from
};

/// Nothing when the landmark is behind the camera, outside the image, too near or far for the pyramid, or seen from
/// further around than 60 degrees.
std::optional<LandmarkView> PredictView(const Landmark& landmark, const Eigen::Vector3d& position_in_map,
                                        const RigidTransform& camera_from_map, const Eigen::Vector3d& center_in_map,
                                        const CameraModel& camera, const PyramidScales& scales);

struct SearchWindow {
  Eigen::Vector2d center_px;
  double radius_px;
  int min_octave, max_octave;
};

/// Looks for the keypoint that fits a descriptor best inside a window. Reused to spare allocations.
class KeypointSearch {
 public:
  /// Index of the best accepted keypoint, or -1. With `ratio` < 1 the best must be nearer than ratio times the second
  /// best, unless they lie on different octaves. `accept(index)` says which keypoints count.
  template <typename Accept>
  int FindBest(const FrameFeatures& features, const Descriptor& descriptor, const SearchWindow& window,
               int max_distance, double ratio, Accept accept) {
    features.grid.FindNear(window.center_px, window.radius_px, window.min_octave, window.max_octave, &nearby_);
    int best = -1, best_distance = 257, second_distance = 257, best_octave = -1, second_octave = -1;
    for (const int index : nearby_) {
      if (!accept(index)) continue;
      const int distance = HammingDistance(descriptor, features.descriptors[index]);
      const int octave = features.keypoints[index].octave;
      if (distance < best_distance) {
        second_distance = best_distance, second_octave = best_octave;
        best_distance = distance, best_octave = octave, best = index;
      } else if (distance < second_distance) {
        second_distance = distance, second_octave = octave;
      }
    }
    distance_ = best_distance;
    if (best_distance > max_distance) return -1;
    if (best_octave == second_octave && best_distance > ratio * second_distance) return -1;
    return best;
  }

  /// Whether the last search's window held an accepted keypoint at all, however unlike.
  bool IsAnyNear() const { return distance_ < 257; }
  /// Hamming distance of the last search's best keypoint.
  int distance() const { return distance_; }

 private:
  std::vector<int> nearby_;
  int distance_ = 257;
};

}  // namespace kinemap
