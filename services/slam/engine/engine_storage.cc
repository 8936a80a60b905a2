// SPDX-License-Identifier: Apache-2.0
// How the engine's maps come into a file and back.
#include <algorithm>
#include <set>
#include <stdexcept>

#include "engine.h"

namespace kinemap {
namespace {

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

void Engine::SettleMaps() {
  const std::optional<KeyframeId> mapped = new_keyframe_;
  FinishMapping();
  if (map() == nullptr) return;
  mapper_.Settle(map());
  TakeLens();
  places_.Follow(map());
  TrackingResult unreported;
  if (mapped) LookForLoops(*mapped, &unreported);
  loop_closer_.Settle(&atlas_);
}

void Engine::Settle() {
  SettleMaps();
  if (semi_dense_) semi_dense_->Settle();
}

MapSnapshot Engine::Snapshot() {
  FinishMapping();
  return MapSnapshot(atlas_, camera_);
}

void Engine::RequireUnused() const {
  if (begun_ || frame_index_ >= 0 || !atlas_.maps().empty()) {
    throw std::logic_error("maps can only be loaded before the first frame, and once");
  }
}

void Engine::LoadMaps(const std::string& path) {
  RequireUnused();
  NamingFile(path,
             [&](const std::vector<uint8_t>& bytes) { SetLens(RemainingRadial(ReadMaps(bytes, camera_, &atlas_))); });
  RenameObjects(atlas_);
  BeginInLoadedMaps();
}

void Engine::ResumeMaps(const std::string& path, int64_t first_free_map_id) {
  RequireUnused();
  NamingFile(path,
             [&](const std::vector<uint8_t>& bytes) { SetLens(RemainingRadial(ReadMaps(bytes, camera_, &atlas_))); });
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

}  // namespace kinemap
