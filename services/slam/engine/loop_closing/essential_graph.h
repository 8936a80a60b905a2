// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include "loop_closing/loop_verifier.h"
#include "map/slam_map.h"
#include "optimization/pose_graph.h"

namespace kinemap {

struct EssentialGraphOptions {
  int min_shared = 100;    ///< landmarks that two keyframes share to be tied, beside each to its strongest elder
  double loop_trust = 10;  ///< of an edge that was measured at one place rather than over many
};

/// How a keyframe's surroundings move in the map: new map position = correction * old.
using Corrections = std::map<KeyframeId, SimilarityTransform>;

/// A graph of all live keyframes: each tied to the elder one it shares most landmarks with, to those it shares many
/// with, and by recognised places (Mur-Artal, Montiel and Tardos 2015, section III-D), the new one among them. The
/// first keyframe is fixed. Both keyframes of the loop must be live and in this map.
PoseGraph CopyEssentialGraph(const EssentialGraphOptions& options, const SlamMap& map, const VerifiedLoop& loop);

/// What solving did to each node.
Corrections CorrectionsOf(const PoseGraph& before, const PoseGraph& solved);

}  // namespace kinemap
