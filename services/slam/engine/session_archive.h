// SPDX-License-Identifier: Apache-2.0
#pragma once

// What of a session goes into a checkpoint besides its maps: the parts' states, taken apart and checked when read.
#include <cmath>
#include <deque>
#include <string>
#include <vector>

#include "ground/ground_scale.h"
#include "loop_closing/loop_detector.h"
#include "loop_closing/place_agreement.h"
#include "map_update.h"
#include "semi_dense/semi_dense_state.h"
#include "storage/feature_codec.h"
#include "storage/image_codec.h"
#include "storage/serialize.h"
#include "tracking/map_initializer.h"

namespace kinemap {

/// Throws MapFileError that says what of the file is damaged.
inline void Require(bool holds, const char* what) {
  if (!holds) throw MapFileError(std::string("damaged: ") + what);
}

constexpr double kFarthestSeenPx = 1e6;

template <typename Archive>
void Serialize(Archive& archive, LoopDetector::Group& group) {
  auto& [keyframes, streak] = group;
  archive(keyframes, streak);
}

template <typename Archive>
void Serialize(Archive& archive, PlaceAgreement::State& agreement) {
  auto& [keyframe_id, matched_id, matched_from_keyframe, count] = agreement;
  archive(keyframe_id, matched_id, matched_from_keyframe, count);
}

template <typename Archive>
void Serialize(Archive& archive, LateFramePose& late) {
  auto& [timestamp_ns, reference_keyframe_id, camera_from_reference] = late;
  archive(timestamp_ns, reference_keyframe_id, camera_from_reference);
}

template <typename Archive>
void Serialize(Archive& archive, PastRoadView& past) {
  auto& [view, reference_id, from_reference] = past;
  archive(view.intensity, view.usable, reference_id, from_reference);
}

template <typename Archive>
void Serialize(Archive& archive, RoadSample& sample) {
  auto& [timestamp_ns, older_id, newer_id, older_from_reference, newer_from_reference, heights, sigma] = sample;
  archive(timestamp_ns, older_id, newer_id, older_from_reference, newer_from_reference, heights, sigma);
}

template <typename Archive>
void Serialize(Archive& archive, GroundPlane& plane) {
  auto& [normal, height] = plane;
  archive(normal, height);
}

template <typename Archive>
void Serialize(Archive& archive, InverseDepth& estimate) {
  auto& [value, sigma] = estimate;
  archive(value, sigma);
}

template <typename Archive>
void Serialize(Archive& archive, SemiDensePoint& point) {
  auto& [position, depth_sigma, grey, state, category, object_id] = point;
  archive(position, depth_sigma, grey, state, category, object_id);
}

template <typename Archive>
void Serialize(Archive& archive, SemiDenseCloud& cloud) {
  auto& [keyframe_id, points] = cloud;
  archive(keyframe_id, points);
}

template <typename Archive>
void Serialize(Archive& archive, KeyframeView& view) {
  auto& [id, timestamp_ns, grey, gradient, labels, range] = view;
  cv::Mat index = labels.index();
  std::vector<FeatureLabel> of_index = labels.labels();
  archive(id, timestamp_ns, grey, index, of_index, range.farthest, range.nearest);
  if constexpr (Archive::kReads) {
    const bool fits = index.empty() || (index.size() == grey.size() && index.type() == CV_8U);
    Require(fits && grey.type() == CV_8U && !of_index.empty(), "a keyframe's image");
    for (const uint8_t label : cv::Mat_<uint8_t>(index)) Require(label < of_index.size(), "a pixel's label");
    Require(std::isfinite(range.farthest) && std::isfinite(range.nearest), "a keyframe's range");
    labels = PixelLabels(index, of_index);
  }
}

template <typename Archive>
void Serialize(Archive& archive, OpenKeyframe& open) {
  auto& [view, estimated, estimates, finished] = open;
  archive(view, estimated, estimates, finished);
  if constexpr (Archive::kReads) {
    for (const InverseDepth& estimate : estimates) {
      Require(std::isfinite(estimate.value) && std::isfinite(estimate.sigma), "an inverse depth");
    }
  }
}

/// Writes or reads frames and what holds some, for which it takes a camera; checks what it reads.
template <typename Archive>
class SessionArchive {
 public:
  SessionArchive(Archive* archive, const CameraModel& camera, int pyramid_levels)
      : archive_(*archive), camera_(camera), pyramid_levels_(pyramid_levels) {}

  void operator()(Frame& frame) {
    auto& [timestamp_ns, tracked_since_ns, features, labels, landmark_ids, camera_from_map, reference_keyframe_id] =
        frame;
    bool has_features = features != nullptr;
    archive_(timestamp_ns, tracked_since_ns, labels, landmark_ids, camera_from_map, reference_keyframe_id,
             has_features);
    if constexpr (Archive::kReads) {
      if (has_features) features = ReadFeatures(camera_, pyramid_levels_, &archive_);
      const size_t count = has_features ? features->keypoints.size() : 0;
      Require(labels.size() == count && landmark_ids.size() == count, "a frame's features");
    } else if (has_features) {
      WriteFeatures(*features, &archive_);
    }
  }

  void operator()(InitializerState& state) {
    bool has_reference = state.reference.has_value();
    archive_(has_reference, state.last_seen_px, state.reason);
    if (!has_reference) return;
    if (!state.reference) state.reference.emplace();
    (*this)(*state.reference);
    Require(state.reference->features != nullptr, "the first view");
    Require(state.last_seen_px.size() == state.reference->features->keypoints.size(), "the first view's features");
    for (const Eigen::Vector2d& pixel_px : state.last_seen_px) {
      Require(pixel_px.cwiseAbs().maxCoeff() < kFarthestSeenPx, "the first view's pixels");
    }
  }

  void operator()(std::deque<Frame>& frames) {
    auto count = static_cast<uint64_t>(frames.size());
    archive_(count);
    if constexpr (Archive::kReads) {
      for (uint64_t i = 0; i < count; ++i) (*this)(frames.emplace_back());
    } else {
      for (Frame& frame : frames) (*this)(frame);
    }
  }

  void operator()(GroundScaleState& state) {
    auto& [odometer, samples, map_id, log_scale, corrected_at, plane] = state;
    archive_(odometer.expected_normal, odometer.recent_normal, odometer.normals, odometer.views, odometer.height,
             samples, map_id, log_scale, corrected_at, plane);
  }

 private:
  Archive& archive_;
  const CameraModel& camera_;
  int pyramid_levels_;
};

/// `map` is the one it measures in; null when that was merged into another, after which none of this is looked at
/// again.
inline bool IsUsable(const GroundScaleState& state, const RoadViewer& viewer, const SlamMap* map) {
  const auto is_known = [&](KeyframeId id) { return map == nullptr || map->FindKeyframe(id) != nullptr; };
  const cv::Size size(viewer.width_px(), viewer.height_px());
  for (const PastRoadView& past : state.odometer.views) {
    const auto& [intensity, usable] = past.view;
    const bool is_view = intensity.type() == CV_32F && usable.type() == CV_8U && intensity.size() == size;
    if (!is_view || usable.size() != size || !is_known(past.reference_id)) return false;
  }
  for (const RoadSample& sample : state.samples) {
    if (!is_known(sample.older_reference_id) || !is_known(sample.newer_reference_id)) return false;
    if (!(sample.heights > 0) || !(sample.sigma > 0) || !std::isfinite(sample.heights + sample.sigma)) return false;
  }
  return state.odometer.expected_normal.allFinite() && state.odometer.recent_normal.allFinite() &&
         state.odometer.normals >= 0 && std::isfinite(state.log_scale);
}

}  // namespace kinemap
