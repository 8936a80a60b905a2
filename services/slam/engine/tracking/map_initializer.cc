// SPDX-License-Identifier: Apache-2.0
#include "tracking/map_initializer.h"

#include <algorithm>
#include <cstdio>

namespace kinemap {
namespace {

// A motion counts only when the next best explains clearly less, and it explains most inliers itself: not all, because
// in traffic the epipolar lines also fit features that move along them.
constexpr double kAmbiguity = 0.7;
constexpr double kLeastSupport = 0.8;

template <typename... Values>
std::string Format(const char* format, Values... values) {
  char text[160];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

double MedianDisplacementPx(const std::vector<PixelPair>& pairs) {
  std::vector<double> moved_px;
  for (const PixelPair& pair : pairs) moved_px.push_back((pair.second_px - pair.first_px).norm());
  const auto middle = moved_px.begin() + static_cast<std::ptrdiff_t>(moved_px.size() / 2);
  std::nth_element(moved_px.begin(), middle, moved_px.end());
  return *middle;
}

int CountTracked(const Frame& frame) {
  return static_cast<int>(std::count_if(frame.labels.begin(), frame.labels.end(),
                                        [](const FeatureLabel& label) { return label.role == FeatureRole::kTracked; }));
}

}  // namespace

void MapInitializer::StartFrom(const Frame& frame) {
  const int tracked = CountTracked(frame);
  if (tracked < options_.min_features) {
    reference_.reset();
    reason_ = Format("%d trackable features, %d needed", tracked, options_.min_features);
    return;
  }
  reference_ = frame;
  matcher_.emplace(frame);
}

void MapInitializer::StartAgain() {
  reference_.reset();
  reason_ = "no frame yet";
}

InitializerState MapInitializer::state() const {
  return {reference_, reference_ ? matcher_->last_seen_px() : std::vector<Eigen::Vector2d>(), reason_};
}

void MapInitializer::Restore(InitializerState state) {
  reference_ = std::move(state.reference);
  reason_ = std::move(state.reason);
  if (!reference_) return;
  matcher_.emplace(*reference_);
  matcher_->Restore(std::move(state.last_seen_px));
}

std::optional<InitialMap> MapInitializer::Try(const Frame& current, RandomEngine& random) {
  if (!reference_) {
    StartFrom(current);
    if (reference_) reason_ = "waiting for a second view";
    return std::nullopt;
  }
  InitialMap initial;
  initial.matches = matcher_->Match(*reference_, current);
  const int matches = static_cast<int>(initial.matches.size());
  if (matches < options_.min_matches) {
    reason_ = Format("%d matches with the first view, %d needed: starting again", matches, options_.min_matches);
    StartFrom(current);
    return std::nullopt;
  }
  std::vector<PixelPair> pairs;
  for (const FeatureMatch& match : initial.matches) {
    pairs.push_back(
        {reference_->features->keypoints[match.query].pixel_px, current.features->keypoints[match.train].pixel_px});
  }
  const double moved_px = MedianDisplacementPx(pairs);
  if (moved_px < options_.min_displacement_px) {
    reason_ = Format("the camera stands still: matches moved by %.1f px in the median, %.1f needed", moved_px,
                     options_.min_displacement_px);
    return std::nullopt;
  }
  std::optional<TwoViewMotion> motion = FindMotion(pairs, random, &initial.from_homography);
  if (!motion) return std::nullopt;
  initial.motion = std::move(*motion);
  initial.reference = std::move(*reference_);
  reference_.reset();
  reason_.clear();
  return initial;
}

std::optional<TwoViewMotion> MapInitializer::FindMotion(const std::vector<PixelPair>& pairs, RandomEngine& random,
                                                        bool* from_homography) {
  const TwoViewModel homography = EstimateHomography(pairs, options_.sigma_px, options_.ransac_iterations, random);
  const TwoViewModel fundamental = EstimateFundamental(pairs, options_.sigma_px, options_.ransac_iterations, random);
  const double total = homography.score + fundamental.score;
  if (total <= 0) {
    reason_ = "neither a homography nor a fundamental matrix fits the matches";
    return std::nullopt;
  }
  *from_homography = homography.score / total > options_.homography_ratio;
  const char* name = *from_homography ? "homography" : "fundamental matrix";
  const TwoViewModel& model = *from_homography ? homography : fundamental;
  std::vector<TwoViewMotion> motions = *from_homography
                                           ? MotionsFromHomography(model, pairs, camera_, options_.sigma_px)
                                           : MotionsFromFundamental(model, pairs, camera_, options_.sigma_px);
  if (motions.empty()) {
    reason_ = Format("the %s gives no motion", name);
    return std::nullopt;
  }
  const TwoViewMotion& best = motions.front();
  const auto inliers = std::count(model.inlier.begin(), model.inlier.end(), true);
  const auto points = std::count(best.triangulated.begin(), best.triangulated.end(), true);
  if (best.in_front < kLeastSupport * inliers) {
    reason_ = Format("%s: %d of %d inliers agree with the best motion", name, best.in_front, static_cast<int>(inliers));
  } else if (best.parallax_deg < options_.min_parallax_deg) {
    reason_ = Format("%s: parallax %.2f degrees, %.2f needed", name, best.parallax_deg, options_.min_parallax_deg);
  } else if (motions.size() > 1 && motions[1].in_front > kAmbiguity * best.in_front) {
    reason_ =
        Format("%s: two motions explain the matches (%d and %d points)", name, best.in_front, motions[1].in_front);
  } else if (points < options_.min_points) {
    reason_ = Format("%s: %d points with depth, %d needed", name, static_cast<int>(points), options_.min_points);
  } else {
    return best;
  }
  return std::nullopt;
}

}  // namespace kinemap
