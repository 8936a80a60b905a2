// SPDX-License-Identifier: Apache-2.0
#include "loop_closing/place_agreement.h"

#include <cmath>

namespace kinemap {
namespace {

/// As the two maps, or the two ends of one, are now.
SimilarityTransform OtherFromOne(const SlamMap& other, const SlamMap& one, const PlaceAgreement::State& proposal) {
  return other.MapFromAnchor(proposal.matched_id) * proposal.matched_from_keyframe *
         one.MapFromAnchor(proposal.keyframe_id).Inverse();
}

}  // namespace

bool PlaceAgreement::Agrees(Atlas* atlas, const State& newest) const {
  if (state_.count == 0) return false;
  const SlamMap* one = atlas->MapOf(newest.keyframe_id);
  const SlamMap* other = atlas->MapOf(newest.matched_id);
  if (atlas->MapOf(state_.keyframe_id) != one || atlas->MapOf(state_.matched_id) != other) return false;
  const SimilarityTransform before = OtherFromOne(*other, *one, state_), now = OtherFromOne(*other, *one, newest);
  const Eigen::Vector3d center = one->MapFromKeyframe(newest.keyframe_id).translation;
  const double off = (before * center - now * center).norm();
  const double depth = now.scale * one->MedianDepth(newest.keyframe_id);
  return off <= options_.most_off * depth &&
         before.rotation.angularDistance(now.rotation) <= options_.most_turned_rad &&
         std::abs(std::log(before.scale / now.scale)) <= std::log(options_.most_scale_factor);
}

bool PlaceAgreement::IsApart(Atlas* atlas, const State& newest) const {
  const SlamMap* map = atlas->MapOf(newest.keyframe_id);
  const Eigen::Vector3d way =
      map->MapFromKeyframe(newest.keyframe_id).translation - map->MapFromKeyframe(state_.keyframe_id).translation;
  return way.norm() >= options_.least_apart * map->MedianDepth(newest.keyframe_id);
}

int PlaceAgreement::Needed(Atlas* atlas, const VerifiedLoop& loop) const {
  if (loop.within_drift) return options_.within_drift;
  const bool one_map = atlas->MapOf(loop.keyframe_id) == atlas->MapOf(loop.matched_id);
  return one_map ? options_.beyond_drift : options_.of_another_map;
}

bool PlaceAgreement::Takes(Atlas* atlas, const VerifiedLoop& loop) {
  const State newest{loop.keyframe_id, loop.matched_id, loop.matched_from_keyframe, 1};
  if (!Agrees(atlas, newest)) {
    // The first place that a keyframe recognises is the likeliest.
    if (newest.keyframe_id == state_.keyframe_id) return false;
    state_ = newest;
  } else if (IsApart(atlas, newest)) {
    const int count = state_.count + 1;
    state_ = newest;
    state_.count = count;
  }
  return state_.count >= Needed(atlas, loop);
}

}  // namespace kinemap
