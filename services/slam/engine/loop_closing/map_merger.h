// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "loop_closing/loop_verifier.h"
#include "map/atlas.h"

namespace kinemap {

/// Puts two maps that share a recognised place into one. The elder map's frame of reference survives; where only one of
/// the two is in metres, so is what they become.
class MapMerger {
 public:
  /// Does nothing when both keyframes lie in one map. Returns the map that holds both.
  static SlamMap& Merge(Atlas* atlas, const VerifiedLoop& loop);
};

}  // namespace kinemap
