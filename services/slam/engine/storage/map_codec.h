// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <set>

#include "map/slam_map.h"
#include "storage/byte_reader.h"
#include "storage/byte_writer.h"

namespace kinemap {

using FeaturesByKeyframe = std::map<KeyframeId, FrameFeaturesPtr>;

/// Writes all of a map but its keyframes' features, and reads it back to the last bit.
class MapCodec {
 public:
  static void Write(const SlamMap& map, ByteWriter* writer);

  /// Throws MapFileError for a map that contradicts itself.
  static std::unique_ptr<SlamMap> Read(const PyramidScales& scales, const FeaturesByKeyframe& features,
                                       ByteReader* reader);

  /// Has the next TakeChanges tell of everything.
  static void MarkAllChanged(SlamMap* map);

  /// Numbers of the blocks that its ids are of, and that it goes on with.
  static std::set<int64_t> Blocks(const SlamMap& map);

  /// All objects that a landmark or a feature belongs to.
  static std::set<uint32_t> Objects(const SlamMap& map);
  /// Old number -> new number; the others stay.
  static void RenameObjects(const std::map<uint32_t, uint32_t>& names, SlamMap* map);

 private:
  template <typename Archive>
  static void Fields(Archive& archive, SlamMap& map);
  template <typename Archive, typename T>
  static void Table(Archive& archive, IdTable<T>& table);
  static void Check(const SlamMap& map);
  static void CheckKeyframe(const SlamMap& map, const Keyframe& keyframe);
  static void CheckLandmark(const SlamMap& map, const Landmark& landmark);
  static void CheckFused(const SlamMap& map);
};

}  // namespace kinemap
