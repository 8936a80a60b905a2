// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "geometry/similarity_transform.h"
#include "map/ids.h"

namespace kinemap {

struct PoseGraphNode {
  KeyframeId keyframe_id;
  SimilarityTransform map_from_node;
  bool fixed = false;
};

/// What was once measured between two nodes.
struct PoseGraphEdge {
  int first, second;  ///< indices
  SimilarityTransform first_from_second;
  double trust = 1;  ///< its standard deviations are the options' over this
};

struct PoseGraph {
  std::vector<PoseGraphNode> nodes;
  std::vector<PoseGraphEdge> edges;
};

struct PoseGraphOptions {
  int iterations = 100;
  double tolerance = 1e-6;        ///< ends when an iteration lowers the cost by less than this part of it
  double rotation_rad = 0.002;    ///< standard deviation of an edge's turn
  double relative_length = 0.01;  ///< of its translation, as part of its length
  double relative_scale = 0.01;   ///< of its change of scale
  bool fixed_scale = false;       ///< lengths are known: nodes keep their scale
};

/// Distributes what the edges disagree about over all nodes that are not fixed, in place (Strasdat, Montiel and
/// Davison, "Scale drift-aware large scale monocular SLAM", 2010). Translation, turn and scale of an edge are compared
/// apart, the translation in the first node's frame and units. Bounded by iterations, never by time, on one thread.
void SolvePoseGraph(const PoseGraphOptions& options, PoseGraph* graph);

}  // namespace kinemap
