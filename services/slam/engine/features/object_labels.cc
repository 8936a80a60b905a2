// SPDX-License-Identifier: Apache-2.0
#include "features/object_labels.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace kinemap {
namespace {

FeatureLabel LabelInState(Stage stage, MotionState state, bool masks_fresh) {
  FeatureLabel label;
  if (stage == Stage::kDynamic) {
    label.role = FeatureRole::kMapped;
    label.state = MotionState::kPotentiallyDynamic;
    return label;
  }
  const bool decided = masks_fresh && (state == MotionState::kStatic || state == MotionState::kNonMoving ||
                                       state == MotionState::kMoving);
  if (!decided) {
    label.role = FeatureRole::kMapped;
    label.state = MotionState::kUndecided;
  } else if (state == MotionState::kMoving) {
    label.role = FeatureRole::kSighted;
    label.state = MotionState::kMoving;
  } else {
    label.role = FeatureRole::kTracked;
    label.state = MotionState::kNonMoving;
  }
  return label;
}

}  // namespace

ObjectLabels::ObjectLabels(Stage stage, const cv::Mat& track_image, const std::vector<ObjectRow>& rows,
                           bool masks_fresh, int border_px, const PyramidScales& scales)
    : stage_(stage),
      track_image_(track_image),
      unlisted_(LabelInState(stage, MotionState::kUndecided, masks_fresh)),
      border_px_(border_px),
      scales_(scales) {
  for (const ObjectRow& row : rows) {
    FeatureLabel label = LabelInState(stage, row.state, masks_fresh);
    label.object_id = row.id;
    label.category = row.category;
    label_of_object_[row.id] = label;
  }
}

uint32_t ObjectLabels::ObjectAt(int column, int row) const {
  return static_cast<uint32_t>(track_image_.at<int32_t>(row, column));
}

bool ObjectLabels::IsBorder(int column, int row, uint32_t object_id, double scale) const {
  const auto out_of_tracking = [&](uint32_t id) { return LabelOfObject(id).role != FeatureRole::kTracked; };
  const int border = static_cast<int>(std::lround(border_px_ * scale));
  for (int r = std::max(0, row - border); r <= std::min(track_image_.rows - 1, row + border); ++r) {
    for (int c = std::max(0, column - border); c <= std::min(track_image_.cols - 1, column + border); ++c) {
      const uint32_t other = ObjectAt(c, r);
      if (other == object_id) continue;
      if (std::max(std::abs(r - row), std::abs(c - column)) <= border_px_) return true;
      if (out_of_tracking(object_id) || out_of_tracking(other)) return true;
    }
  }
  return false;
}

FeatureLabel ObjectLabels::LabelOfObject(uint32_t object_id) const {
  if (stage_ == Stage::kBase || object_id == 0) return {};
  const auto known = label_of_object_.find(object_id);
  FeatureLabel label = known != label_of_object_.end() ? known->second : unlisted_;
  label.object_id = object_id;
  return label;
}

FeatureLabel ObjectLabels::LabelOf(const Keypoint& keypoint) const {
  if (stage_ == Stage::kBase || track_image_.empty()) return {};
  const int column = std::clamp(static_cast<int>(std::lround(keypoint.raw_px.x())), 0, track_image_.cols - 1);
  const int row = std::clamp(static_cast<int>(std::lround(keypoint.raw_px.y())), 0, track_image_.rows - 1);
  const uint32_t object_id = ObjectAt(column, row);
  FeatureLabel label = LabelOfObject(object_id);
  if (IsBorder(column, row, object_id, scales_.scale(keypoint.octave))) label.role = FeatureRole::kIgnored;
  return label;
}

std::vector<FeatureLabel> ObjectLabels::LabelsOf(const std::vector<Keypoint>& keypoints) const {
  std::vector<FeatureLabel> labels;
  labels.reserve(keypoints.size());
  for (const Keypoint& keypoint : keypoints) labels.push_back(LabelOf(keypoint));
  return labels;
}

}  // namespace kinemap
