// SPDX-License-Identifier: Apache-2.0
#include "tracking/relocalizer.h"

#include <algorithm>

#include "features/node_matcher.h"
#include "geometry/absolute_pose.h"
#include "map/lasting.h"
#include "tracking/landmark_projection.h"

namespace kinemap {
namespace {

constexpr int kInTurn = 2;
constexpr int kNeighbors = 10;
constexpr double kWideRadiusPx = 10.0, kNarrowRadiusPx = 4.0;
constexpr double kBruteForceRatio = 0.75;

void AddOnce(KeyframeId id, std::vector<KeyframeId>* ids) {
  if (std::find(ids->begin(), ids->end(), id) == ids->end()) ids->push_back(id);
}

}  // namespace

std::vector<KeyframeId> Relocalizer::Candidates(const SlamMap& map, const BagOfWords& bag,
                                                const Eigen::Vector3d& last_center_in_map, int lost_frames) const {
  std::vector<KeyframeId> candidates;
  if (HasPlaces()) {
    const auto accept = [&](KeyframeId id) { return map.FindKeyframe(id) != nullptr; };
    const auto neighbors = [&](KeyframeId id) { return map.covisibility().Neighbors(id, kNeighbors); };
    for (const PlaceCandidate& place : places_->QueryGroups(bag, options_.candidates, accept, neighbors)) {
      AddOnce(place.keyframe_id, &candidates);
    }
  }
  const std::vector<KeyframeId> live = map.LiveKeyframes();
  std::vector<std::pair<double, KeyframeId>> ranked;
  for (const KeyframeId id : live) {
    ranked.emplace_back((map.keyframe(id).map_from_keyframe.translation - last_center_in_map).norm(), id);
  }
  std::sort(ranked.begin(), ranked.end());
  const size_t nearest = std::min(ranked.size(), static_cast<size_t>(options_.nearest));
  for (size_t i = 0; i < nearest; ++i) AddOnce(ranked[i].second, &candidates);
  if (HasPlaces()) return candidates;
  for (int i = 0; i < kInTurn; ++i) {
    AddOnce(live[(static_cast<size_t>(lost_frames) * kInTurn + i) % live.size()], &candidates);
  }
  return candidates;
}

int Relocalizer::Match(const SlamMap& map, KeyframeId keyframe_id, const BagOfWords& bag, Frame* frame) const {
  frame->ForgetMatches();
  const Keyframe& keyframe = map.keyframe(keyframe_id);
  std::vector<int> query, train;
  for (int i = 0; i < keyframe.features->size(); ++i) {
    const Landmark* landmark = map.FindLandmark(keyframe.landmark_ids[i]);
    if (landmark != nullptr && IsLasting(*landmark)) query.push_back(i);
  }
  for (int j = 0; j < frame->size(); ++j) {
    if (frame->IsFree(j)) train.push_back(j);
  }
  const BagOfWords* keyframe_bag = HasPlaces() ? places_->bag(keyframe_id) : nullptr;
  const std::vector<FeatureMatch> matches =
      keyframe_bag != nullptr ? MatchByNode(*keyframe.features, query, *keyframe_bag, *frame->features, train, bag,
                                            {options_.max_match_distance, options_.match_ratio})
                              : MatchByDescriptor(*keyframe.features, query, *frame->features, train, kBruteForceRatio);
  for (const FeatureMatch& match : matches) frame->landmark_ids[match.train] = keyframe.landmark_ids[match.query];
  return static_cast<int>(matches.size());
}

bool Relocalizer::SolveByThreePoints(const SlamMap& map, Frame* frame) const {
  std::vector<PointSight> sights;
  std::vector<int> keypoints;
  for (int i = 0; i < frame->size(); ++i) {
    const Landmark* landmark = map.FindLandmark(frame->landmark_ids[i]);
    if (landmark == nullptr) continue;
    const Keypoint& keypoint = frame->features->keypoints[i];
    sights.push_back(
        {map.PositionInMap(*landmark), keypoint.pixel_px, options_.max_error_px * map.scales().scale(keypoint.octave)});
    keypoints.push_back(i);
  }
  AbsolutePoseOptions ransac;
  ransac.least_inliers = options_.least_ransac_inliers;
  RandomEngine random(options_.seed, frame->timestamp_ns);
  const std::optional<AbsolutePose> pose = EstimateAbsolutePose(sights, camera_, ransac, &random);
  if (!pose) return false;
  frame->camera_from_map = pose->camera_from_map;
  for (size_t i = 0; i < keypoints.size(); ++i) {
    if (!pose->inlier[i]) frame->landmark_ids[keypoints[i]] = kNoId;
  }
  return true;
}

bool Relocalizer::TryKeyframe(const SlamMap& map, KeyframeId keyframe_id, const BagOfWords& bag, Frame* frame) const {
  if (Match(map, keyframe_id, bag, frame) < options_.least_matches) return false;
  if (!SolveByThreePoints(map, frame)) return false;
  if (solver_.Solve(map, frame).inliers < options_.least_ransac_inliers) return false;
  std::vector<KeyframeId> around = map.covisibility().Neighbors(keyframe_id, kNeighbors);
  around.insert(around.begin(), keyframe_id);
  const std::vector<LandmarkId> landmarks = LastingLandmarks(map, around);
  int inliers = 0;
  for (const double radius_px : {kWideRadiusPx, kNarrowRadiusPx}) {
    ProjectLandmarks(map, camera_, landmarks, radius_px, kMaxHammingDistance, frame);
    inliers = solver_.Solve(map, frame).inliers;
    if (inliers < options_.least_ransac_inliers) return false;
  }
  frame->reference_keyframe_id = keyframe_id;
  return inliers >= options_.least_inliers;
}

const BagOfWords& Relocalizer::BagOf(const Frame& frame) {
  if (HasPlaces() && described_ != frame.features) {
    bag_ = places_->Describe(*frame.features, frame.labels);
    described_ = frame.features;
  }
  return bag_;
}

bool Relocalizer::Relocalize(const SlamMap& map, const Eigen::Vector3d& last_center_in_map, int lost_frames,
                             Frame* frame) {
  const BagOfWords& bag = BagOf(*frame);
  for (const KeyframeId candidate : Candidates(map, bag, last_center_in_map, lost_frames)) {
    if (TryKeyframe(map, candidate, bag, frame)) return true;
  }
  frame->ForgetMatches();
  return false;
}

}  // namespace kinemap
