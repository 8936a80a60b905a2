// SPDX-License-Identifier: Apache-2.0
#include "storage/map_snapshot.h"

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <utility>

#include "storage/feature_codec.h"

namespace kinemap {
namespace {

constexpr char kCamera[] = "camera", kMaps[] = "maps", kFeatures[] = "features", kLens[] = "lens";
constexpr double kSameParameter = 1e-9;

/// Everything that observations in the map depend on besides the images.
std::vector<double> EyeOf(const CameraModel& camera, const PyramidScales& scales) {
  std::vector<double> eye = camera.Parameters();
  eye.push_back(scales.levels());
  eye.push_back(scales.scale(scales.levels() - 1));
  return eye;
}

/// What the numbers of `EyeOf` are, in their order.
constexpr std::array kEyeNames = {"width",
                                  "height",
                                  "fx",
                                  "fy",
                                  "cx",
                                  "cy",
                                  "k1",
                                  "k2",
                                  "p1",
                                  "p2",
                                  "k3",
                                  "k4",
                                  "lens",
                                  "baseline in metres",
                                  "right image made from depth",
                                  "pyramid levels",
                                  "scale of the last level"};

const std::vector<uint8_t>& Find(const Sections& sections, const char* name) {
  const auto found = sections.find(name);
  if (found == sections.end()) throw MapFileError("damaged: without its section '" + std::string(name) + "'");
  return found->second;
}

void CheckEye(const Sections& sections, const std::vector<double>& expected) {
  std::vector<double> eye;
  ByteReader(Find(sections, kCamera))(eye);
  if (eye.size() != expected.size()) throw MapFileError("was made with a camera that this version does not know");
  for (size_t i = 0; i < eye.size(); ++i) {
    if (std::abs(eye[i] - expected[i]) <= kSameParameter * std::max(1.0, std::abs(expected[i]))) continue;
    std::ostringstream text;
    text << "was made with another camera or pyramid: " << kEyeNames.at(i) << " " << eye[i] << ", expected "
         << expected[i];
    throw MapFileError(text.str());
  }
}

// No two maps may hold, or go on with, the same ids, nor with those that later maps will have.
void CheckBlocks(const std::map<int64_t, std::unique_ptr<SlamMap>>& maps, int64_t next_map_id) {
  std::set<int64_t> taken;
  for (const auto& [map_id, map] : maps) {
    for (const int64_t block : MapCodec::Blocks(*map)) {
      if (block >= next_map_id || !taken.insert(block).second) {
        throw MapFileError("damaged: ids of block " + std::to_string(block) + " in map " + std::to_string(map_id));
      }
    }
  }
}

}  // namespace

MapSnapshot::MapSnapshot(const Atlas& atlas, const CameraModel& camera) {
  ByteWriter eye, maps;
  eye(EyeOf(camera, atlas.scales()));
  sections_[kCamera] = std::move(eye.bytes());
  maps(atlas.next_map_id(), atlas.active() == nullptr ? int64_t{-1} : atlas.active()->map_id(),
       static_cast<uint64_t>(atlas.maps().size()));
  for (const auto& map : atlas.maps()) {
    MapCodec::Write(*map, &maps);
    for (const KeyframeId id : map->LiveKeyframes()) features_[id] = map->keyframe(id).features;
  }
  sections_[kMaps] = std::move(maps.bytes());
  ByteWriter lens;
  lens(camera.remaining_radial());
  sections_[kLens] = std::move(lens.bytes());
}

double RemainingRadial(const Sections& sections) {
  const auto found = sections.find(kLens);
  if (found == sections.end()) return 0;
  double radial = 0;
  ByteReader(found->second)(radial);
  if (!(std::abs(radial) < CameraModel::kMostRemainingRadial)) throw MapFileError("damaged: its camera's distortion");
  return radial;
}

std::vector<uint8_t> MapSnapshot::Bytes() const {
  ByteWriter features;
  features(static_cast<uint64_t>(features_.size()));
  for (const auto& [id, of_keyframe] : features_) {
    features(id);
    WriteFeatures(*of_keyframe, &features);
  }
  Sections sections = sections_;
  sections[kFeatures] = std::move(features.bytes());
  return PackSections(sections);
}

Sections ReadMaps(const std::vector<uint8_t>& bytes, const CameraModel& camera, Atlas* atlas) {
  Sections sections = UnpackSections(bytes);
  CheckEye(sections, EyeOf(camera, atlas->scales()));
  FeaturesByKeyframe features;
  ByteReader feature_reader(Find(sections, kFeatures));
  const size_t keyframes = feature_reader.TakeCount();
  for (size_t i = 0; i < keyframes; ++i) {
    KeyframeId id = kNoId;
    feature_reader(id);
    features[id] = ReadFeatures(camera, atlas->scales().levels(), &feature_reader);
  }
  sections.erase(kFeatures);
  ByteReader reader(Find(sections, kMaps));
  int64_t next_map_id = 0, active = -1;
  reader(next_map_id, active);
  const size_t count = reader.TakeCount();
  std::map<int64_t, std::unique_ptr<SlamMap>> maps;
  for (size_t i = 0; i < count; ++i) {
    std::unique_ptr<SlamMap> map = MapCodec::Read(atlas->scales(), features, &reader);
    const int64_t map_id = map->map_id();
    if (!maps.emplace(map_id, std::move(map)).second) throw MapFileError("damaged: holds a map twice");
  }
  if (!reader.IsAtEnd()) throw MapFileError("damaged: goes on after its last map");
  CheckBlocks(maps, next_map_id);
  if (next_map_id < 0 || next_map_id > INT32_MAX) throw MapFileError("damaged: number of the next map");
  for (auto& [map_id, map] : maps) atlas->Add(std::move(map));
  atlas->ReserveMapIds(next_map_id);
  atlas->Deactivate();
  if (active >= 0) atlas->Activate(active);
  return sections;
}

}  // namespace kinemap
