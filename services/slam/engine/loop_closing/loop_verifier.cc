// SPDX-License-Identifier: Apache-2.0
#include "loop_closing/loop_verifier.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "optimization/sim3_optimizer.h"

namespace kinemap {
namespace {

constexpr int kSurroundingNeighbors = 10;
constexpr int kConfirmingNeighbors = 5;
constexpr double kWideRadiusPx = 8.0, kNarrowRadiusPx = 4.0;

}  // namespace

/// The keyframe in its map and the candidate in the same or another one.
struct LoopVerifier::Sides {
  const SlamMap& map;
  const Keyframe& keyframe;
  const SlamMap& candidate_map;
  const Keyframe& candidate;
  std::vector<KeyframeId> window;     ///< the candidate and the neighbours matched by words
  std::vector<LandmarkId> landmarks;  ///< around the candidate

  /// Pose that a keyframe of the first map has in the candidate's, in whose units it is.
  RigidTransform TargetFromCandidateMap(const SimilarityTransform& keyframe_from_candidate,
                                        KeyframeId target_id) const {
    const SimilarityTransform candidate_map_from_keyframe =
        SimilarityTransform(candidate.map_from_keyframe) * keyframe_from_candidate.Inverse();
    const RigidTransform keyframe_from_target =
        keyframe.map_from_keyframe.Inverse() * map.keyframe(target_id).map_from_keyframe;
    return (candidate_map_from_keyframe * SimilarityTransform(keyframe_from_target)).WithoutScale().Inverse();
  }
};

std::vector<LandmarkMatch> LoopVerifier::MatchWindow(const Sides& sides, const PlaceIndex& places) const {
  const KeypointsByNode own(sides.map, sides.keyframe, *places.bag(sides.keyframe.id));
  std::map<int, LandmarkMatch> best_of_keypoint;
  std::map<LandmarkId, int> keypoint_of_landmark;
  for (const KeyframeId id : sides.window) {
    const BagOfWords* other_bag = places.bag(id);
    if (other_bag == nullptr) continue;
    const KeypointsByNode other(sides.candidate_map, sides.candidate_map.keyframe(id), *other_bag);
    for (const LandmarkMatch& match : MatchByWords(own, other)) {
      // The keyframes of the window see the same landmarks; the first to match one decides.
      if (!keypoint_of_landmark.try_emplace(match.landmark_id, match.keypoint).second) continue;
      const auto [entry, is_new] = best_of_keypoint.try_emplace(match.keypoint, match);
      if (!is_new && match.distance < entry->second.distance) entry->second = match;
    }
  }
  std::vector<LandmarkMatch> matches;
  for (const auto& [keypoint, match] : best_of_keypoint) matches.push_back(match);
  return matches;
}

std::vector<PointPair> LoopVerifier::Pairs(const Sides& sides, const std::vector<LandmarkMatch>& matches) const {
  const RigidTransform keyframe_from_map = sides.keyframe.map_from_keyframe.Inverse();
  const RigidTransform candidate_from_map = sides.candidate.map_from_keyframe.Inverse();
  const PyramidScales& scales = sides.map.scales();
  std::vector<PointPair> pairs;
  for (const LandmarkMatch& match : matches) {
    const Landmark* own = sides.map.FindLandmark(sides.keyframe.landmark_ids[match.keypoint]);
    if (own == nullptr || !IsLasting(*own)) continue;
    const Landmark& other = *sides.candidate_map.FindLandmark(match.landmark_id);
    PointPair pair;
    pair.in_first = keyframe_from_map * sides.map.PositionInMap(*own);
    pair.in_second = candidate_from_map * sides.candidate_map.PositionInMap(other);
    if (pair.in_second.z() <= 0) continue;
    const Keypoint& keypoint = sides.keyframe.features->keypoints[match.keypoint];
    pair.first_px = keypoint.pixel_px;
    pair.first_inverse_variance = scales.inverse_variance(keypoint.octave);
    const auto observed = other.observations.find(sides.candidate.id);
    if (observed != other.observations.end()) {
      const Keypoint& seen = sides.candidate.features->keypoints[observed->second];
      pair.second_px = seen.pixel_px;
      pair.second_inverse_variance = scales.inverse_variance(seen.octave);
    } else {
      // A neighbour of the candidate saw it; the candidate would see it here.
      pair.second_px = camera_.Project(pair.in_second);
      pair.second_inverse_variance = pair.first_inverse_variance;
    }
    pairs.push_back(pair);
  }
  return pairs;
}

std::vector<LandmarkMatch> LoopVerifier::Project(const Sides& sides, const SimilarityTransform& keyframe_from_candidate,
                                                 KeyframeId target_id, double radius_px) const {
  return MatchByProjection(sides.candidate_map, sides.landmarks, camera_,
                           sides.TargetFromCandidateMap(keyframe_from_candidate, target_id),
                           sides.map.keyframe(target_id), radius_px, kStrictHammingDistance);
}

double LoopVerifier::Spread(const Keyframe& keyframe, const std::vector<LandmarkMatch>& matches) const {
  double sum = 0, sum_of_squares = 0;
  for (const LandmarkMatch& match : matches) {
    const double x = keyframe.features->keypoints[match.keypoint].pixel_px.x() / camera_.width_px();
    sum += x;
    sum_of_squares += x * x;
  }
  const double count = static_cast<double>(matches.size());
  return std::sqrt(std::max(0.0, sum_of_squares / count - sum * sum / (count * count)));
}

bool LoopVerifier::IsConfirmed(const Sides& sides, const SimilarityTransform& keyframe_from_candidate) const {
  int confirmations = 0;
  for (const KeyframeId id : sides.map.covisibility().Neighbors(sides.keyframe.id, kConfirmingNeighbors)) {
    const size_t found = Project(sides, keyframe_from_candidate, id, kWideRadiusPx).size();
    if (found >= static_cast<size_t>(options_.min_neighbor_matches)) ++confirmations;
  }
  return confirmations >= options_.min_confirmations;
}

std::optional<VerifiedLoop> LoopVerifier::Verify(Atlas* atlas, const PlaceIndex& places, KeyframeId keyframe_id,
                                                 KeyframeId candidate_id, bool fixed_scale,
                                                 RandomEngine& random) const {
  const SlamMap& map = *atlas->MapOf(keyframe_id);
  const SlamMap& candidate_map = *atlas->MapOf(candidate_id);
  std::vector<KeyframeId> window = candidate_map.covisibility().Neighbors(candidate_id, options_.neighbors);
  window.insert(window.begin(), candidate_id);
  std::vector<KeyframeId> around = candidate_map.covisibility().Neighbors(candidate_id, kSurroundingNeighbors);
  around.push_back(candidate_id);
  Sides sides{map, map.keyframe(keyframe_id), candidate_map, candidate_map.keyframe(candidate_id), window, {}};

  const std::vector<LandmarkMatch> by_words = MatchWindow(sides, places);
  if (by_words.size() < static_cast<size_t>(options_.min_word_matches)) return std::nullopt;
  Sim3RansacOptions ransac = options_.ransac;
  ransac.fixed_scale = fixed_scale;
  const auto rough = EstimateSim3(camera_, Pairs(sides, by_words), ransac, random);
  if (!rough) return std::nullopt;
  sides.landmarks = LastingLandmarks(candidate_map, around);
  const std::vector<LandmarkMatch> wide = Project(sides, rough->first_from_second, keyframe_id, kWideRadiusPx);
  const Sim3Estimate fine = Sim3Optimizer(camera_, fixed_scale).Optimize(rough->first_from_second, Pairs(sides, wide));
  if (fine.inliers < options_.min_sim3_inliers) return std::nullopt;
  std::vector<LandmarkMatch> matches = Project(sides, fine.first_from_second, keyframe_id, kNarrowRadiusPx);
  if (matches.size() < static_cast<size_t>(options_.min_matches)) return std::nullopt;
  if (!IsConfirmed(sides, fine.first_from_second)) return std::nullopt;
  const bool within_drift = &map == &candidate_map && IsWithinDrift(options_.drift, map, keyframe_id, candidate_id,
                                                                    fine.first_from_second.Inverse(), fixed_scale);
  if (!within_drift && Spread(sides.keyframe, matches) < options_.min_spread) return std::nullopt;

  // Of cameras in their maps' units, turned into one of what is anchored at the two.
  const SimilarityTransform candidate_anchor(Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero(),
                                             sides.candidate.scale);
  const SimilarityTransform keyframe_anchor(Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero(),
                                            sides.keyframe.scale);
  return VerifiedLoop{
      keyframe_id, candidate_id, candidate_anchor.Inverse() * fine.first_from_second.Inverse() * keyframe_anchor,
      fixed_scale, within_drift, std::move(matches)};
}

}  // namespace kinemap
