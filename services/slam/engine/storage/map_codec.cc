// SPDX-License-Identifier: Apache-2.0
#include "storage/map_codec.h"

#include <string>
#include <utility>

#include "storage/feature_codec.h"
#include "storage/serialize.h"

namespace kinemap {

template <typename Archive, typename T>
void MapCodec::Table(Archive& archive, IdTable<T>& table) {
  std::vector<int64_t> numbers;
  for (const auto& block : table.blocks()) numbers.push_back(block.number);
  archive(numbers);
  for (const int64_t number : numbers) {
    if constexpr (Archive::kReads) {
      if (number < 0 || number > INT32_MAX) throw MapFileError("damaged: ids of map " + std::to_string(number));
      const size_t count = archive.TakeCount();
      for (size_t i = 0; i < count; ++i) {
        bool there = false;
        archive(there);
        if (!there) {
          table.AppendGap(number);
          continue;
        }
        const int64_t id = table.NextId(number);
        T& entry = table.Append(number, std::make_unique<T>());
        archive(entry);
        if (entry.id != id)
          throw MapFileError("damaged: " + std::to_string(entry.id) + " at the place of " + std::to_string(id));
      }
    } else {
      for (const auto& block : table.blocks()) {
        if (block.number != number) continue;
        archive(static_cast<uint64_t>(block.entries.size()));
        for (const auto& entry : block.entries) {
          archive(entry != nullptr);
          if (entry != nullptr) archive(*entry);
        }
      }
    }
  }
}

template <typename Archive>
void MapCodec::Fields(Archive& archive, SlamMap& map) {
  archive(map.id_block_, map.last_keyframe_id_, map.metric_scale_);
  Table(archive, map.keyframes_);
  Table(archive, map.landmarks_);
  archive(map.fused_into_, map.landmarks_of_object_, map.changed_keyframes_, map.changed_landmarks_,
          map.removed_landmarks_, map.reported_landmarks_);
}

void MapCodec::Write(const SlamMap& map, ByteWriter* writer) {
  (*writer)(map.map_id());
  Fields(*writer, const_cast<SlamMap&>(map));
  const std::vector<KeyframeId> live = map.LiveKeyframes();
  for (const KeyframeId id : live) (*writer)(map.covisibility().Edges(id));
}

std::unique_ptr<SlamMap> MapCodec::Read(const PyramidScales& scales, const FeaturesByKeyframe& features,
                                        ByteReader* reader) {
  int64_t map_id = 0;
  (*reader)(map_id);
  auto map = std::make_unique<SlamMap>(map_id, scales);
  Fields(*reader, *map);
  for (const auto& block : map->keyframes_.blocks()) {
    for (const auto& keyframe : block.entries) {
      if (keyframe == nullptr) throw MapFileError("damaged: a keyframe is missing");
      ++map->keyframe_count_;
      if (keyframe->culled) continue;
      ++map->live_keyframes_;
      map->turnover_.inserted.push_back(keyframe->id);
      const auto found = features.find(keyframe->id);
      if (found != features.end()) keyframe->features = found->second;
    }
  }
  map->landmarks_.ForEach([&](const Landmark&) { ++map->live_landmarks_; });
  Check(*map);
  for (const KeyframeId id : map->LiveKeyframes()) {
    std::map<KeyframeId, int> edges;
    (*reader)(edges);
    for (const auto& [other, shared] : edges) {
      const Keyframe* neighbor = map->FindKeyframe(other);
      if (neighbor == nullptr || neighbor->culled) throw MapFileError("damaged: a neighbour that is not there");
    }
    map->covisibility_.SetEdges(id, edges);
  }
  return map;
}

void MapCodec::MarkAllChanged(SlamMap* map) {
  map->keyframes_.ForEach([&](const Keyframe& keyframe) { map->changed_keyframes_.insert(keyframe.id); });
  map->landmarks_.ForEach([&](const Landmark& landmark) { map->changed_landmarks_.insert(landmark.id); });
  map->removed_landmarks_.clear();
}

std::set<int64_t> MapCodec::Blocks(const SlamMap& map) {
  std::set<int64_t> numbers{map.id_block_};
  for (const auto& block : map.keyframes_.blocks()) numbers.insert(block.number);
  for (const auto& block : map.landmarks_.blocks()) numbers.insert(block.number);
  return numbers;
}

std::set<uint32_t> MapCodec::Objects(const SlamMap& map) {
  std::set<uint32_t> objects;
  map.landmarks_.ForEach([&](const Landmark& landmark) { objects.insert(landmark.object_id); });
  map.keyframes_.ForEach([&](const Keyframe& keyframe) {
    for (const FeatureLabel& label : keyframe.labels) objects.insert(label.object_id);
  });
  objects.erase(0);
  return objects;
}

void MapCodec::RenameObjects(const std::map<uint32_t, uint32_t>& names, SlamMap* map) {
  const auto rename = [&](uint32_t* object) {
    const auto found = names.find(*object);
    if (found != names.end()) *object = found->second;
  };
  for (const LandmarkId id : map->LiveLandmarks()) rename(&map->FindLandmark(id)->object_id);
  std::map<uint32_t, std::vector<LandmarkId>> renamed;
  for (auto& [object, landmarks] : map->landmarks_of_object_) {
    uint32_t name = object;
    rename(&name);
    renamed[name] = std::move(landmarks);
  }
  map->landmarks_of_object_ = std::move(renamed);
  for (const KeyframeId id : map->LiveKeyframes()) {
    for (FeatureLabel& label : map->mutable_keyframe(id).labels) rename(&label.object_id);
  }
}

}  // namespace kinemap
