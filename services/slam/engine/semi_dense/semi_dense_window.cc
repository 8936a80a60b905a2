// SPDX-License-Identifier: Apache-2.0
#include "semi_dense/semi_dense_window.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "semi_dense/gradient_pixels.h"
#include "semi_dense/hypothesis_fusion.h"
#include "semi_dense/inter_keyframe_check.h"
#include "semi_dense/intra_keyframe_check.h"

namespace kinemap {
namespace {
constexpr int kMarginPx = 4;
constexpr float kAgreedSigmas = 3;
}  // namespace

std::vector<SemiDenseCloud> SemiDenseWindow::Advance(WindowStep step) {
  std::erase_if(entries_, [&](const Entry& entry) { return step.map_from_anchor.count(entry.view.id) == 0; });
  if (step.entering) {
    view_builder_.Complete(&*step.entering);
    entries_.emplace_back();
    entries_.back().view = std::move(*step.entering);
  }
  const int count = static_cast<int>(entries_.size());
  const int estimate_until = step.is_last ? count : count - options_.later_keyframes;
  const int finish_until = step.is_last ? count : estimate_until - options_.later_keyframes;
  for (int i = 0; i < estimate_until; ++i) {
    if (entries_[i].estimates.empty()) Estimate(i, step.map_from_anchor);
  }
  std::vector<SemiDenseCloud> finished;
  for (int i = 0; i < finish_until; ++i) {
    if (!entries_[i].finished) finished.push_back(Finish(i, step.map_from_anchor));
  }
  if (step.is_last) entries_.clear();
  return finished;
}

std::deque<OpenKeyframe> SemiDenseWindow::state() const {
  std::deque<OpenKeyframe> state;
  for (const Entry& entry : entries_) {
    OpenKeyframe& open = state.emplace_back();
    open.view = entry.view;
    open.view.gradient.release();
    open.estimated = !entry.estimates.empty();
    open.finished = entry.finished;
    for (const cv::Point& pixel : entry.pixels) open.estimates.push_back(entry.estimates.At(pixel.x, pixel.y));
  }
  return state;
}

void SemiDenseWindow::Restore(const std::deque<OpenKeyframe>& state) {
  entries_.clear();
  for (const OpenKeyframe& open : state) {
    Entry& entry = entries_.emplace_back();
    entry.view = open.view;
    ViewBuilder::AddGradient(&entry.view);
    entry.finished = open.finished;
    if (open.estimated) {
      entry.estimates = InverseDepthImage(camera_.width_px(), camera_.height_px());
      entry.pixels = GradientPixels(entry.view);
    }
    if (entry.pixels.size() != open.estimates.size()) {
      throw std::invalid_argument("expected " + std::to_string(entry.pixels.size()) + " semi-dense estimates, got " +
                                  std::to_string(open.estimates.size()));
    }
    for (size_t i = 0; i < entry.pixels.size(); ++i) {
      entry.estimates.At(entry.pixels[i].x, entry.pixels[i].y) = open.estimates[i];
    }
  }
}

std::vector<cv::Point> SemiDenseWindow::GradientPixels(const KeyframeView& view) const {
  if (!view.range.IsKnown()) return {};
  return FindGradientPixels(view, options_.least_gradient, options_.most_pixels, kMarginPx);
}

std::vector<int> SemiDenseWindow::NeighborsOf(int index, int count) const {
  // Nearest first, a later one before an earlier one.
  std::vector<int> neighbors;
  for (int away = 1; static_cast<int>(neighbors.size()) < count && away < static_cast<int>(entries_.size()); ++away) {
    for (const int other : {index + away, index - away}) {
      if (other < 0 || other >= static_cast<int>(entries_.size())) continue;
      if (static_cast<int>(neighbors.size()) < count) neighbors.push_back(other);
    }
  }
  return neighbors;
}

InverseDepth SemiDenseWindow::EstimatePixel(const cv::Point& pixel, const DepthRange& range,
                                            const std::vector<EpipolarSearch>& searches) const {
  std::vector<InverseDepth> hypotheses;
  DepthRange searched = range;
  for (size_t i = 0; i < searches.size(); ++i) {
    const int possible = static_cast<int>(hypotheses.size() + searches.size() - i);
    if (possible < options_.least_hypotheses) return {};
    const std::optional<InverseDepth> found = searches[i].Find(pixel.x, pixel.y, searched);
    if (!found) continue;
    // Once two keyframes agree, the others only have to look there.
    for (const InverseDepth& earlier : hypotheses) {
      if (!AreCompatible(earlier, *found)) continue;
      const float reach = kAgreedSigmas * std::max(earlier.sigma, found->sigma);
      const float middle = 0.5f * (earlier.value + found->value);
      searched = {std::max(range.farthest, middle - reach), std::min(range.nearest, middle + reach)};
    }
    hypotheses.push_back(*found);
  }
  return FuseHypotheses(hypotheses, options_.least_hypotheses);
}

void SemiDenseWindow::Estimate(int index, const Poses& map_from_anchor) {
  Entry& entry = entries_[index];
  entry.estimates = InverseDepthImage(camera_.width_px(), camera_.height_px());
  entry.pixels = GradientPixels(entry.view);
  if (entry.pixels.empty()) return;
  const SimilarityTransform& map_from_own = map_from_anchor.at(entry.view.id);
  std::vector<EpipolarSearch> searches;
  for (const int other : NeighborsOf(index, options_.neighbors)) {
    const KeyframeView& view = entries_[other].view;
    searches.emplace_back(options_.search, camera_, entry.view, view,
                          map_from_anchor.at(view.id).Inverse() * map_from_own);
  }
  for (const cv::Point& pixel : entry.pixels) {
    entry.estimates.At(pixel.x, pixel.y) = EstimatePixel(pixel, entry.view.range, searches);
  }
  CheckAgainstNeighbors(entry.view, entry.pixels, &entry.estimates);
}

SemiDenseCloud SemiDenseWindow::Finish(int index, const Poses& map_from_anchor) {
  Entry& entry = entries_[index];
  entry.finished = true;
  std::vector<OtherEstimates> others;
  for (const int other : NeighborsOf(index, options_.neighbors)) {
    if (entries_[other].estimates.empty()) continue;
    others.push_back({&entries_[other].estimates,
                      map_from_anchor.at(entries_[other].view.id).Inverse() * map_from_anchor.at(entry.view.id)});
  }
  InverseDepthImage checked = entry.estimates;
  CheckAgainstKeyframes(camera_, entry.pixels, others, options_.least_consistent, &checked);
  SemiDenseCloud cloud;
  cloud.keyframe_id = entry.view.id;
  for (const cv::Point& pixel : entry.pixels) {
    const InverseDepth& estimate = checked.At(pixel.x, pixel.y);
    if (!estimate.IsKnown() || estimate.sigma > options_.max_relative_sigma * estimate.value) continue;
    const Eigen::Vector3f position = camera_.Ray({pixel.x, pixel.y}).cast<float>() / estimate.value;
    const FeatureLabel& label = entry.view.labels.LabelAt(pixel.x, pixel.y);
    cloud.points.push_back({{position.x(), position.y(), position.z()},
                            estimate.sigma / (estimate.value * estimate.value),
                            entry.view.grey.at<uint8_t>(pixel.y, pixel.x),
                            label.state,
                            static_cast<int16_t>(label.category),
                            label.object_id});
  }
  return cloud;
}

}  // namespace kinemap
