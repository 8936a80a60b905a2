// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "loop_closing/loop_verifier.h"
#include "map/atlas.h"

namespace kinemap {

struct PlaceAgreementOptions {
  int within_drift = 3;           ///< keyframes that agree before a place is believed that the camera may have come to
  int of_another_map = 3;         ///< the same before another map is joined
  int beyond_drift = 5;           ///< the same before a place of this map that its drift bound refuses is believed
  double least_apart = 0.1;       ///< between one of them and the next, of their landmarks' depth
  double most_off = 0.15;         ///< between the places that two of them give a camera, of its landmarks' depth
  double most_turned_rad = 0.05;  ///< between the directions they give it
  double most_scale_factor = 1.15;  ///< between the units they give it
};

/// A place that only looks alike is found out a few metres further on: keyframes that recognise it, each by itself, no
/// longer lay its surroundings onto the camera's in the same way. So several must agree, from places apart: a camera
/// that stands in a queue sees one picture again and again.
class PlaceAgreement {
 public:
  /// The newest proposal that counts, and how many in a row it agrees with, itself included.
  struct State {
    KeyframeId keyframe_id = kNoId, matched_id = kNoId;
    SimilarityTransform matched_from_keyframe;  ///< between what is anchored at the two
    int count = 0;
  };

  explicit PlaceAgreement(const PlaceAgreementOptions& options) : options_(options) {}

  /// Takes in a place that a new keyframe recognised. Whether enough agree by now.
  bool Takes(Atlas* atlas, const VerifiedLoop& loop);

  void Forget() { state_ = State(); }

  const State& state() const { return state_; }
  void Restore(const State& state) { state_ = state; }

 private:
  bool Agrees(Atlas* atlas, const State& newest) const;
  bool IsApart(Atlas* atlas, const State& newest) const;
  int Needed(Atlas* atlas, const VerifiedLoop& loop) const;

  PlaceAgreementOptions options_;
  State state_;
};

}  // namespace kinemap
