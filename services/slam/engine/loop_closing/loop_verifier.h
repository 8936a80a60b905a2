// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "geometry/random_engine.h"
#include "geometry/sim3_ransac.h"
#include "loop_closing/drift_bound.h"
#include "loop_closing/place_matcher.h"
#include "map/atlas.h"
#include "map/place_index.h"

namespace kinemap {

struct LoopVerifierOptions {
  int neighbors = 5;              ///< of the candidate, matched with the keyframe too
  int min_word_matches = 20;      ///< before RANSAC
  int min_sim3_inliers = 20;      ///< of the refined similarity
  int min_matches = 40;           ///< after projecting the candidate's surroundings into the keyframe
  int min_neighbor_matches = 25;  ///< the same in a neighbour of the keyframe, which then confirms it
  int min_confirmations = 2;      ///< such neighbours, of the five that share most
  double min_spread = 0.1;        ///< of matches across the image where no way bounds what may be believed (standard
                                  ///< deviation, widths): one house looks like many
  Sim3RansacOptions ransac;
  DriftBoundOptions drift;
};

/// A place that a keyframe shows again.
struct VerifiedLoop {
  KeyframeId keyframe_id;
  KeyframeId matched_id;  ///< may lie in another map
  /// Between what is anchored at the two.
  SimilarityTransform matched_from_keyframe;
  bool fixed_scale;                    ///< both sides are in the same units
  bool within_drift;                   ///< one map, in which the camera may have come there; else others must agree
  std::vector<LandmarkMatch> matches;  ///< keypoints of the keyframe, landmarks around the matched one
};

/// Makes sure that two keyframes show one place: matches by words, a similarity between the two cameras by RANSAC and
/// optimisation, enough landmarks around the candidate found again in the keyframe and in its neighbours
/// (Mur-Artal, Montiel and Tardos 2015, section VII-B; neighbours: Campos et al. 2021, section VI-A); between two maps,
/// and where more must have been lost on the way than a map loses, matches over much of the image.
class LoopVerifier {
 public:
  /// With `fixed_scale` both sides are in the same units.
  LoopVerifier(const LoopVerifierOptions& options, const CameraModel& camera) : options_(options), camera_(camera) {}

  std::optional<VerifiedLoop> Verify(Atlas* atlas, const PlaceIndex& places, KeyframeId keyframe_id,
                                     KeyframeId candidate_id, bool fixed_scale, RandomEngine& random) const;

 private:
  struct Sides;
  std::vector<LandmarkMatch> MatchWindow(const Sides& sides, const PlaceIndex& places) const;
  std::vector<PointPair> Pairs(const Sides& sides, const std::vector<LandmarkMatch>& matches) const;
  std::vector<LandmarkMatch> Project(const Sides& sides, const SimilarityTransform& keyframe_from_candidate,
                                     KeyframeId target_id, double radius_px) const;
  double Spread(const Keyframe& keyframe, const std::vector<LandmarkMatch>& matches) const;
  bool IsConfirmed(const Sides& sides, const SimilarityTransform& keyframe_from_candidate) const;

  LoopVerifierOptions options_;
  CameraModel camera_;
};

}  // namespace kinemap
