// SPDX-License-Identifier: Apache-2.0
#include "map/place_index.h"

#include <algorithm>
#include <set>

namespace kinemap {
namespace {

constexpr double kLeastOfBestGroup = 0.75;

bool MoreSimilar(const PlaceCandidate& a, const PlaceCandidate& b) {
  return a.similarity != b.similarity ? a.similarity > b.similarity : a.keyframe_id < b.keyframe_id;
}

}  // namespace

PlaceIndex::PlaceIndex(std::shared_ptr<const Vocabulary> vocabulary) : vocabulary_(std::move(vocabulary)) {
  if (vocabulary_ != nullptr) entries_of_word_.resize(vocabulary_->word_count());
}

BagOfWords PlaceIndex::Describe(const FrameFeatures& features, const std::vector<FeatureLabel>& labels) const {
  if (vocabulary_ == nullptr) return {};
  std::vector<uint8_t> used(features.size());
  for (int i = 0; i < features.size(); ++i) {
    used[i] = labels[i].role == FeatureRole::kTracked && labels[i].state == MotionState::kStatic;
  }
  return vocabulary_->Describe(features.descriptors, used);
}

void PlaceIndex::Add(const Keyframe& keyframe) {
  if (vocabulary_ == nullptr || keyframe.culled || slot_of_.count(keyframe.id) > 0) return;
  int slot = static_cast<int>(slots_.size());
  if (free_slots_.empty()) {
    slots_.emplace_back();
  } else {
    slot = free_slots_.back();
    free_slots_.pop_back();
  }
  slots_[slot] = {keyframe.id, Describe(*keyframe.features, keyframe.labels)};
  slot_of_[keyframe.id] = slot;
  for (const auto& [word, weight] : slots_[slot].bag.words) entries_of_word_[word].push_back({slot, weight});
}

void PlaceIndex::Remove(KeyframeId id) {
  const auto found = slot_of_.find(id);
  if (found == slot_of_.end()) return;
  const int slot = found->second;
  for (const auto& [word, weight] : slots_[slot].bag.words) {
    std::vector<Entry>& entries = entries_of_word_[word];
    entries.erase(std::find_if(entries.begin(), entries.end(), [&](const Entry& entry) { return entry.slot == slot; }));
  }
  slots_[slot] = {kNoId, {}};
  free_slots_.push_back(slot);
  slot_of_.erase(found);
}

void PlaceIndex::Follow(SlamMap* map) {
  const KeyframeTurnover turnover = map->TakeTurnover();
  for (const KeyframeId id : turnover.inserted) Add(map->keyframe(id));
  for (const KeyframeId id : turnover.culled) Remove(id);
}

const BagOfWords* PlaceIndex::bag(KeyframeId id) const {
  const auto found = slot_of_.find(id);
  return found == slot_of_.end() ? nullptr : &slots_[found->second].bag;
}

std::vector<PlaceCandidate> PlaceIndex::Query(const BagOfWords& bag, const Accept& accept) const {
  std::vector<double> shared(slots_.size(), 0);
  for (const auto& [word, weight] : bag.words) {
    for (const Entry& entry : entries_of_word_[word]) shared[entry.slot] += std::min(weight, entry.weight);
  }
  std::vector<PlaceCandidate> candidates;
  for (size_t slot = 0; slot < slots_.size(); ++slot) {
    if (shared[slot] > 0 && accept(slots_[slot].id)) candidates.push_back({slots_[slot].id, shared[slot]});
  }
  std::sort(candidates.begin(), candidates.end(), MoreSimilar);
  return candidates;
}

std::vector<PlaceCandidate> PlaceIndex::QueryGroups(const BagOfWords& bag, int max_count, const Accept& accept,
                                                    const Neighbors& neighbors) const {
  std::map<KeyframeId, double> similarity_of;
  for (const PlaceCandidate& candidate : Query(bag, accept)) {
    similarity_of[candidate.keyframe_id] = candidate.similarity;
  }
  std::vector<PlaceCandidate> groups;
  for (const auto& [id, similarity] : similarity_of) {
    PlaceCandidate best{id, similarity};
    double sum = similarity;
    for (const KeyframeId neighbor : neighbors(id)) {
      const auto found = similarity_of.find(neighbor);
      if (found == similarity_of.end()) continue;
      sum += found->second;
      if (MoreSimilar({neighbor, found->second}, best)) best = {neighbor, found->second};
    }
    groups.push_back({best.keyframe_id, sum});
  }
  std::sort(groups.begin(), groups.end(), MoreSimilar);
  std::vector<PlaceCandidate> chosen;
  std::set<KeyframeId> standing;
  for (const PlaceCandidate& group : groups) {
    if (group.similarity < kLeastOfBestGroup * groups.front().similarity) break;
    if (chosen.size() == static_cast<size_t>(max_count)) break;
    if (standing.insert(group.keyframe_id).second) chosen.push_back(group);
  }
  return chosen;
}

}  // namespace kinemap
