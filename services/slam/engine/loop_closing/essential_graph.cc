// SPDX-License-Identifier: Apache-2.0
#include "loop_closing/essential_graph.h"

#include <set>
#include <utility>

namespace kinemap {
namespace {

constexpr int kMostNeighbors = 1000;

/// The elder keyframe that shares most with this one; the one before it when none shares anything.
KeyframeId StrongestElder(const SlamMap& map, KeyframeId keyframe_id, KeyframeId previous_id) {
  for (const KeyframeId neighbor : map.covisibility().Neighbors(keyframe_id, kMostNeighbors)) {
    if (map.keyframe(neighbor).timestamp_ns < map.keyframe(keyframe_id).timestamp_ns) return neighbor;
  }
  return previous_id;
}

}  // namespace

PoseGraph CopyEssentialGraph(const EssentialGraphOptions& options, const SlamMap& map, const VerifiedLoop& loop) {
  PoseGraph graph;
  std::map<KeyframeId, int> index_of;
  for (const KeyframeId id : map.LiveKeyframes()) {
    index_of[id] = static_cast<int>(graph.nodes.size());
    graph.nodes.push_back({id, map.MapFromAnchor(id), id == map.first_keyframe_id()});
  }
  std::set<std::pair<KeyframeId, KeyframeId>> tied;
  const auto tie = [&](KeyframeId a, KeyframeId b, double trust) {
    if (a == b || index_of.count(a) == 0 || index_of.count(b) == 0) return;
    if (!tied.insert(std::minmax(a, b)).second) return;
    const int first = index_of[a], second = index_of[b];
    graph.edges.push_back(
        {first, second, graph.nodes[first].map_from_node.Inverse() * graph.nodes[second].map_from_node, trust});
  };
  tied.insert(std::minmax(loop.keyframe_id, loop.matched_id));
  graph.edges.push_back(
      {index_of.at(loop.matched_id), index_of.at(loop.keyframe_id), loop.matched_from_keyframe, options.loop_trust});
  KeyframeId previous_id = kNoId;
  for (const auto& [id, index] : index_of) {
    for (const KeyframeId other : map.keyframe(id).loop_edges) tie(id, other, options.loop_trust);
    if (previous_id != kNoId) tie(id, StrongestElder(map, id, previous_id), 1);
    for (const KeyframeId other : map.covisibility().Neighbors(id, kMostNeighbors, options.min_shared)) {
      tie(id, other, 1);
    }
    previous_id = id;
  }
  return graph;
}

Corrections CorrectionsOf(const PoseGraph& before, const PoseGraph& solved) {
  Corrections corrections;
  for (size_t i = 0; i < before.nodes.size(); ++i) {
    corrections[before.nodes[i].keyframe_id] = solved.nodes[i].map_from_node * before.nodes[i].map_from_node.Inverse();
  }
  return corrections;
}

}  // namespace kinemap
