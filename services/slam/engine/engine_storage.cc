// SPDX-License-Identifier: Apache-2.0
// How the engine's maps come into a file and back, with or without the session they were made in.
#include <algorithm>
#include <set>

#include "engine.h"
#include "storage/feature_codec.h"
#include "storage/serialize.h"

namespace kinemap {
namespace {

constexpr char kSession[] = "session";
/// Objects of earlier sessions are renamed downwards from the highest number, out of the way of this session's.
constexpr uint32_t kFirstOfEarlier = 0x80000000u;

void RenameObjects(const Atlas& atlas) {
  std::set<uint32_t> known;
  for (const auto& map : atlas.maps()) known.merge(MapCodec::Objects(*map));
  uint32_t next = UINT32_MAX;
  for (const uint32_t object : known) {
    if (object >= kFirstOfEarlier) next = std::min(next, object - 1);
  }
  std::map<uint32_t, uint32_t> names;
  for (const uint32_t object : known) {
    if (object < kFirstOfEarlier) names[object] = next--;
  }
  for (const auto& map : atlas.maps()) MapCodec::RenameObjects(names, map.get());
}

/// Runs `read` so that what it finds wrong names the file.
template <typename Read>
void NamingFile(const std::string& path, Read read) {
  try {
    read(ReadWholeFile(path));
  } catch (const MapFileError& error) {
    const std::string message = error.what();
    throw MapFileError(message.starts_with("map file ") ? message : "map file " + path + ": " + message);
  }
}

}  // namespace

template <typename Archive>
void Engine::SessionFields(Archive& archive) {
  TrackerState state = tracker_.state();
  auto& [last, last_from_reference, last_scale, velocity, lost_frames, frames_since_relocalization] = state;
  auto& [timestamp_ns, features, labels, landmark_ids, camera_from_map, reference_keyframe_id] = last;
  int lost_in_map = lost_policy_.lost_frames();
  LandmarkCuller::OnTrial on_trial = mapper_.on_trial();
  std::map<uint32_t, MotionState> objects = object_states_.states();
  bool has_features = features != nullptr;
  archive(frame_index_, last_keyframe_index_, last_timestamp_ns_, must_be_recognised_, lost_in_map, on_trial, objects,
          timestamp_ns, labels, landmark_ids, camera_from_map, reference_keyframe_id, last_from_reference, last_scale,
          velocity, lost_frames, frames_since_relocalization, has_features);
  if constexpr (Archive::kReads) {
    if (has_features) features = ReadFeatures(camera_, scales_.levels(), &archive);
    const size_t count = has_features ? features->keypoints.size() : 0;
    if (labels.size() != count || landmark_ids.size() != count)
      throw MapFileError("damaged: the last frame's features");
    if (map() != nullptr && map()->FindKeyframe(reference_keyframe_id) == nullptr) {
      throw MapFileError("damaged: the last frame's reference");
    }
    tracker_.Restore(state);
    lost_policy_.Restore(lost_in_map);
    mapper_.Restore(std::move(on_trial));
    object_states_.Restore(objects);
  } else if (has_features) {
    WriteFeatures(*features, &archive);
  }
}

void Engine::Settle() {
  const std::optional<KeyframeId> mapped = new_keyframe_;
  FinishMapping();
  if (map() == nullptr) return;
  mapper_.Settle(map());
  places_.Follow(map());
  TrackingResult unreported;
  if (mapped) LookForLoops(*mapped, &unreported);
  loop_closer_.Settle(&atlas_);
}

MapSnapshot Engine::Snapshot() {
  FinishMapping();
  MapSnapshot snapshot(atlas_, camera_);
  ByteWriter session;
  SessionFields(session);
  snapshot.Add(kSession, std::move(session.bytes()));
  return snapshot;
}

void Engine::LoadMaps(const std::string& path) {
  NamingFile(path, [&](const std::vector<uint8_t>& bytes) { ReadMaps(bytes, camera_, &atlas_); });
  RenameObjects(atlas_);
  BeginInLoadedMaps();
}

void Engine::ResumeMaps(const std::string& path, int64_t first_free_map_id) {
  NamingFile(path, [&](const std::vector<uint8_t>& bytes) { ReadMaps(bytes, camera_, &atlas_); });
  atlas_.ReserveMapIds(first_free_map_id);
  for (const auto& map : atlas_.maps()) map->set_id_block(atlas_.TakeMapId());
  BeginInLoadedMaps();
}

void Engine::BeginInLoadedMaps() {
  for (const auto& map : atlas_.maps()) {
    places_.Follow(map.get());
    MapCodec::MarkAllChanged(map.get());
  }
  atlas_.Deactivate();
  must_be_recognised_ = true;
}

void Engine::RestoreState(const std::vector<uint8_t>& bytes) {
  const Sections sections = ReadMaps(bytes, camera_, &atlas_);
  for (const auto& map : atlas_.maps()) places_.Follow(map.get());
  const auto session = sections.find(kSession);
  if (session == sections.end()) throw MapFileError("damaged: without its section 'session'");
  ByteReader reader(session->second);
  SessionFields(reader);
}

}  // namespace kinemap
