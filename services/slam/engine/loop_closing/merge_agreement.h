// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "loop_closing/loop_verifier.h"
#include "map/atlas.h"

namespace kinemap {

struct MergeAgreementOptions {
  int agreeing_keyframes = 3;
  double most_off = 0.15;           ///< between the places that two proposals give a camera, of its landmarks' depth
  double most_turned_rad = 0.05;    ///< between the directions they give it
  double most_scale_factor = 1.15;  ///< between the units they give it
};

/// Two maps are joined only when several keyframes, each recognised by itself, lay the one onto the other in the same
/// way. Within a map the way between two places bounds what may be believed (drift_bound.h); between maps there is no
/// way, and a house that looks like another would join two towns. A few metres further on the two no longer agree.
class MergeAgreement {
 public:
  /// The newest proposal, and how many in a row it agrees with, itself included.
  struct State {
    KeyframeId keyframe_id = kNoId, matched_id = kNoId;
    SimilarityTransform matched_from_keyframe;  ///< between what is anchored at the two
    int count = 0;
  };

  explicit MergeAgreement(const MergeAgreementOptions& options) : options_(options) {}

  /// Takes in a place of another map that a new keyframe recognised. Whether enough agree by now.
  bool Takes(Atlas* atlas, const VerifiedLoop& loop);

  void Forget() { state_ = State(); }

  const State& state() const { return state_; }
  void Restore(const State& state) { state_ = state; }

 private:
  bool Agrees(Atlas* atlas, const State& newest) const;

  MergeAgreementOptions options_;
  State state_;
};

}  // namespace kinemap
