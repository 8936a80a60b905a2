// SPDX-License-Identifier: Apache-2.0
// What an engine carries from frame to frame besides its maps, into a checkpoint and back: all of it, so that the next
// frame is tracked as if nothing had happened.
#include <cmath>

#include "engine.h"
#include "storage/image_codec.h"
#include "storage/serialize.h"

namespace kinemap {
namespace {

constexpr char kSession[] = "session";
constexpr double kFarthestPx = 1e6;

void Require(bool holds, const char* what) {
  if (!holds) throw MapFileError(std::string("damaged: ") + what);
}

}  // namespace

// Found by the archives in the namespace of what they take apart.

template <typename Archive>
void Serialize(Archive& archive, LoopDetector::Group& group) {
  auto& [keyframes, streak] = group;
  archive(keyframes, streak);
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

namespace {

/// Writes or reads the engine's parts, checking what it reads.
template <typename Archive>
class SessionArchive {
 public:
  SessionArchive(Archive* archive, const CameraModel& camera, int pyramid_levels)
      : archive_(*archive), camera_(camera), pyramid_levels_(pyramid_levels) {}

  void operator()(Frame& frame) {
    auto& [timestamp_ns, features, labels, landmark_ids, camera_from_map, reference_keyframe_id] = frame;
    bool has_features = features != nullptr;
    archive_(timestamp_ns, labels, landmark_ids, camera_from_map, reference_keyframe_id, has_features);
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
      Require(pixel_px.cwiseAbs().maxCoeff() < kFarthestPx, "the first view's pixels");
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

// `map` is the one it measures in; null when that was merged into another, after which none of this is looked at again.
bool IsUsable(const GroundScaleState& state, const RoadViewer& viewer, const SlamMap* map) {
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

}  // namespace

template <typename Archive>
void Engine::SessionFields(Archive& archive) {
  SessionArchive parts(&archive, camera_, scales_.levels());
  TrackerState tracker = tracker_.state();
  auto& [last, last_from_reference, last_scale, velocity, lost_frames, frames_since_relocalization] = tracker;
  LoopCloserState loops = loop_closer_.state();
  LateMetricScale::State late_scale = late_scale_.state();
  InitializerState initializer = initializer_.state();
  LandmarkCuller::OnTrial on_trial = mapper_.on_trial();
  std::map<uint32_t, MotionState> objects = object_states_.states();
  int lost_in_map = lost_policy_.lost_frames(), features = feature_budget_.next();
  int next_lens = lens_finder_.next_keyframes();
  archive(frame_index_, last_keyframe_index_, last_timestamp_ns_, must_be_recognised_, lost_in_map, features, next_lens,
          on_trial, objects, last_from_reference, last_scale, velocity, lost_frames, frames_since_relocalization,
          loops.candidates, loops.keyframes_since_loop, late_scale.map_id, late_scale.metres_per_unit, late_frames_);
  parts(last);
  parts(initializer);
  parts(waiting_);
  if (ground_scale_) {
    GroundScaleState state = ground_scale_->state();
    parts(state);
    if constexpr (Archive::kReads) {
      const SlamMap* measured = atlas_.Find(state.map_id);
      Require(measured != nullptr || state.map_id < atlas_.next_map_id(), "the map of the road");
      Require(IsUsable(state, ground_scale_->viewer(), measured), "the road");
      ground_scale_->Restore(std::move(state));
    }
  }
  if (semi_dense_) {
    SemiDenseState state = semi_dense_->state();
    archive(state.keyframes, state.window, state.finished, first_view_);
    if constexpr (Archive::kReads) RestoreSemiDense(std::move(state));
  }
  if constexpr (Archive::kReads) {
    Require(archive.IsAtEnd(), "a session of other options");
    Require(features >= options_.features && features <= 2 * options_.features, "number of features");
    Require(map() == nullptr || map()->FindKeyframe(last.reference_keyframe_id) != nullptr,
            "the last frame's reference");
    for (const LateFramePose& late : late_frames_) {
      Require(atlas_.MapOf(late.reference_keyframe_id) != nullptr, "a late frame's reference");
    }
    for (const auto& [landmark, metres] : late_scale.metres_per_unit) {
      Require(metres > 0 && std::isfinite(metres), "metres of a unit");
    }
    tracker_.Restore(tracker);
    loop_closer_.Restore(std::move(loops));
    late_scale_.Restore(std::move(late_scale));
    initializer_.Restore(std::move(initializer));
    mapper_.Restore(std::move(on_trial));
    object_states_.Restore(objects);
    lost_policy_.Restore(lost_in_map);
    lens_finder_.Restore(next_lens);
    feature_budget_.Restore(features);
  }
}

void Engine::RestoreSemiDense(SemiDenseState state) {
  const cv::Size size(camera_.width_px(), camera_.height_px());
  for (const OpenKeyframe& open : state.window) Require(open.view.grey.size() == size, "a keyframe's image");
  Require(!first_view_ || first_view_->grey.size() == size, "the first view's image");
  try {
    semi_dense_->Restore(std::move(state));
  } catch (const std::invalid_argument& error) {
    throw MapFileError(std::string("damaged: ") + error.what());
  }
}

MapSnapshot Engine::Checkpoint() {
  Settle();
  MapSnapshot snapshot(atlas_, camera_);
  ByteWriter session;
  SessionFields(session);
  snapshot.Add(kSession, std::move(session.bytes()));
  return snapshot;
}

void Engine::RestoreState(const std::vector<uint8_t>& bytes) {
  RequireUnused();
  const Sections sections = ReadMaps(bytes, camera_, &atlas_);
  SetLens(RemainingRadial(sections));
  for (const auto& map : atlas_.maps()) places_.Follow(map.get());
  const auto session = sections.find(kSession);
  if (session == sections.end()) throw MapFileError("damaged: without its section 'session'");
  ByteReader reader(session->second);
  SessionFields(reader);
}

}  // namespace kinemap
