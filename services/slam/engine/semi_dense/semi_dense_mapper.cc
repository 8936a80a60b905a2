// SPDX-License-Identifier: Apache-2.0
#include "semi_dense/semi_dense_mapper.h"

#include <iterator>
#include <utility>

#include "semi_dense/landmark_range.h"

namespace kinemap {

SemiDenseMapper::SemiDenseMapper(const SemiDenseOptions& options, const CameraModel& camera)
    : options_(options), window_(options, camera) {}

SemiDenseMapper::~SemiDenseMapper() {
  for (const Work& work : under_way_) work.clouds.wait();
}

void SemiDenseMapper::Add(const SlamMap& map, KeyframeId keyframe_id, cv::Mat image, PixelLabels labels,
                          int64_t frame_index) {
  if (static_cast<int>(under_way_.size()) >= options_.most_under_way) return;
  // Keyframes of a map that is not followed any more have no place beside this one.
  std::erase_if(keyframes_, [&](KeyframeId id) { return map.FindKeyframe(id) == nullptr; });
  keyframes_.push_back(keyframe_id);
  if (static_cast<int>(keyframes_.size()) > options_.window_keyframes) keyframes_.pop_front();
  WindowStep step = StepOf(map);
  step.entering.emplace();
  step.entering->id = keyframe_id;
  step.entering->grey = std::move(image);
  step.entering->labels = std::move(labels);
  step.entering->range = RangeOfLandmarks(map, keyframe_id);
  Start(std::move(step), frame_index + options_.delay_frames);
}

void SemiDenseMapper::Collect(int64_t frame_index) {
  while (!under_way_.empty() && under_way_.front().due_frame <= frame_index) CollectFirst();
}

void SemiDenseMapper::Settle() {
  while (!under_way_.empty()) CollectFirst();
}

void SemiDenseMapper::Restore(SemiDenseState state) {
  window_.Restore(state.window);
  keyframes_ = std::move(state.keyframes);
  finished_ = std::move(state.finished);
}

void SemiDenseMapper::Finish(const SlamMap& map) {
  std::erase_if(keyframes_, [&](KeyframeId id) { return map.FindKeyframe(id) == nullptr; });
  WindowStep step = StepOf(map);
  step.is_last = true;
  Start(std::move(step), 0);
  keyframes_.clear();
  Settle();
}

void SemiDenseMapper::ChangeLens(const SlamMap* map, const CameraModel& camera) {
  if (map != nullptr) Finish(*map);
  while (!under_way_.empty()) CollectFirst();
  keyframes_.clear();
  window_ = SemiDenseWindow(options_, camera);
}

std::vector<SemiDenseCloud> SemiDenseMapper::TakeFinished() { return std::exchange(finished_, {}); }

WindowStep SemiDenseMapper::StepOf(const SlamMap& map) const {
  WindowStep step;
  for (const KeyframeId id : keyframes_) step.map_from_anchor.emplace(id, map.MapFromAnchor(id));
  return step;
}

void SemiDenseMapper::Start(WindowStep step, int64_t due_frame) {
  // One after the other: each piece of work waits for the one before it.
  std::shared_future<std::vector<SemiDenseCloud>> before;
  if (!under_way_.empty()) before = under_way_.back().clouds;
  auto work = [this, before, step = std::move(step)]() mutable {
    if (before.valid()) before.wait();
    return window_.Advance(std::move(step));
  };
  under_way_.push_back({std::async(std::launch::async, std::move(work)).share(), due_frame});
}

void SemiDenseMapper::CollectFirst() {
  std::vector<SemiDenseCloud> clouds = under_way_.front().clouds.get();
  under_way_.pop_front();
  finished_.insert(finished_.end(), std::make_move_iterator(clouds.begin()), std::make_move_iterator(clouds.end()));
}

}  // namespace kinemap
