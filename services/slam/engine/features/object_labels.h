// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <unordered_map>
#include <vector>

#include "features/keypoint.h"
#include "features/pyramid_scales.h"

namespace kinemap {

/// How much is made of the objects in the image (thesis 3.2: base, stage 1, stage 2).
enum class Stage { kBase, kDynamic, kMoving };

/// The same codes in the track image's table, in a landmark and on the bus.
enum class MotionState : uint8_t { kStatic = 0, kNonMoving = 1, kMoving = 2, kUndecided = 3, kPotentiallyDynamic = 4 };

/// What a feature may be used for.
enum class FeatureRole : uint8_t {
  kTracked,  ///< tracking, initialisation, pose estimation, mapping
  kMapped,   ///< triangulated with the poses the others gave; constrains no pose
  kSighted,  ///< on a moving object: placed by depth, once, at the time it was seen
  kIgnored,  ///< on the border of an object: belongs to nobody
};

struct FeatureLabel {
  FeatureRole role = FeatureRole::kTracked;
  MotionState state = MotionState::kStatic;
  uint32_t object_id = 0;  ///< 0: background
  int32_t category = -1;
};

struct ObjectRow {
  uint32_t id;
  int32_t category;
  MotionState state;
};

/// One frame's objects: the track image (pixel = object id, 0 background) and its table.
class ObjectLabels {
 public:
  /// `track_image` is CV_32S and must live as long as this; it may be empty: no objects. An id without a row counts as
  /// not decided. Masks that are not fresh make every object potentially dynamic, whatever its state.
  /// The border is `border_px` wide for features of the finest octave, and grows with the scale of the others around
  /// what stays out of tracking: a corner that an outline makes with what is behind it moves with the object.
  ObjectLabels(Stage stage, const cv::Mat& track_image, const std::vector<ObjectRow>& rows, bool masks_fresh,
               int border_px, const PyramidScales& scales);

  FeatureLabel LabelOf(const Keypoint& keypoint) const;
  /// Of what shows an object, away from its border; id 0: background.
  FeatureLabel LabelOfObject(uint32_t object_id) const;
  std::vector<FeatureLabel> LabelsOf(const std::vector<Keypoint>& keypoints) const;

 private:
  uint32_t ObjectAt(int column, int row) const;
  bool IsBorder(int column, int row, uint32_t object_id, double scale) const;

  Stage stage_;
  cv::Mat track_image_;
  std::unordered_map<uint32_t, FeatureLabel> label_of_object_;  // looked up only, never iterated
  FeatureLabel unlisted_;
  int border_px_;
  PyramidScales scales_;
};

}  // namespace kinemap
