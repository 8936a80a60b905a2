// SPDX-License-Identifier: Apache-2.0
// What an engine carries from frame to frame besides its maps, into a checkpoint and back: all of it, so that the next
// frame is tracked as if nothing had happened.
#include <cmath>
#include <stdexcept>

#include "engine.h"
#include "session_archive.h"

namespace kinemap {
namespace {
constexpr char kSession[] = "session";
}

template <typename Archive>
void Engine::SessionFields(Archive& archive) {
  SessionArchive parts(&archive, camera_, scales_.levels());
  TrackerState tracker = tracker_.state();
  auto& [last, last_from_reference, last_scale, motion, lost_frames, frames_since_relocalization] = tracker;
  auto& [velocity, motion_covariance, turn_noise, shift_noise, motion_depth] = motion;
  LoopCloserState loops = loop_closer_.state();
  LateMetricScale::State late_scale = late_scale_.state();
  InitializerState initializer = initializer_.state();
  LandmarkCuller::OnTrial on_trial = mapper_.on_trial();
  std::map<uint32_t, MotionState> objects = object_states_.states();
  int lost_in_map = lost_policy_.lost_frames(), features = feature_budget_.next();
  int next_lens = lens_finder_.next_keyframes();
  archive(frame_index_, last_keyframe_index_, last_timestamp_ns_, must_be_recognised_, lost_in_map, features, next_lens,
          on_trial, objects, last_from_reference, last_scale, velocity, motion_covariance, turn_noise, shift_noise,
          motion_depth, lost_frames, frames_since_relocalization, loops.candidates, loops.agreement,
          loops.keyframes_since_loop, late_scale.map_id, late_scale.metres_per_unit, late_frames_);
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
    Require(motion_covariance.allFinite() && std::isfinite(turn_noise + shift_noise + motion_depth),
            "what is known of the motion");
    Require(features >= options_.features && features <= 2 * options_.features, "number of features");
    Require(map() == nullptr || map()->FindKeyframe(last.reference_keyframe_id) != nullptr,
            "the last frame's reference");
    Require(loops.agreement.count == 0 || (atlas_.MapOf(loops.agreement.keyframe_id) != nullptr &&
                                           atlas_.MapOf(loops.agreement.matched_id) != nullptr),
            "a recognised place");
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
