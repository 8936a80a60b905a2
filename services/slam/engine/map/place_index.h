// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "features/vocabulary.h"
#include "map/slam_map.h"

namespace kinemap {

/// A keyframe that may show the same place.
struct PlaceCandidate {
  KeyframeId keyframe_id;
  double similarity;  ///< of the two bags, in [0, 1]
};

/// Which keyframes, of whatever map, show what another image shows: an inverted index from words to keyframes. Knows
/// only features on things that stay where they are: parked cars are gone another day.
class PlaceIndex {
 public:
  using Accept = std::function<bool(KeyframeId)>;
  using Neighbors = std::function<std::vector<KeyframeId>(KeyframeId)>;

  /// Null for a vocabulary makes an index that stays empty.
  explicit PlaceIndex(std::shared_ptr<const Vocabulary> vocabulary);

  bool has_vocabulary() const { return vocabulary_ != nullptr; }
  int size() const { return static_cast<int>(slot_of_.size()); }

  /// The bag of an image's static features. Empty without a vocabulary.
  BagOfWords Describe(const FrameFeatures& features, const std::vector<FeatureLabel>& labels) const;

  /// Adding what is there already changes nothing, nor does removing what is not there.
  void Add(const Keyframe& keyframe);
  void Remove(KeyframeId id);
  /// Adds what the map inserted and removes what it culled since the last call.
  void Follow(SlamMap* map);
  /// Null when the keyframe is not in the index.
  const BagOfWords* bag(KeyframeId id) const;

  /// Keyframes that share words with the bag and that `accept` lets pass: most similar first, equal ones by id.
  std::vector<PlaceCandidate> Query(const BagOfWords& bag, const Accept& accept) const;

  /// The same in groups: neighbours show one place, so each keyframe counts with all of its `neighbors` that share
  /// words too; the most similar keyframe stands for its group (Mur-Artal and Tardos 2014, section V). Groups below
  /// three quarters of the best are left out. Best group first; `similarity` is the group's sum.
  std::vector<PlaceCandidate> QueryGroups(const BagOfWords& bag, int max_count, const Accept& accept,
                                          const Neighbors& neighbors) const;

 private:
  struct Entry {
    int slot;
    float weight;
  };
  struct Slot {
    KeyframeId id;
    BagOfWords bag;
  };

  std::shared_ptr<const Vocabulary> vocabulary_;
  std::vector<std::vector<Entry>> entries_of_word_;
  std::vector<Slot> slots_;
  std::vector<int> free_slots_;
  std::map<KeyframeId, int> slot_of_;
};

}  // namespace kinemap
