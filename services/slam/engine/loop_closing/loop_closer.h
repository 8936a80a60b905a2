// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "geometry/camera_model.h"
#include "loop_closing/essential_graph.h"
#include "loop_closing/loop_detector.h"
#include "loop_closing/loop_verifier.h"
#include "loop_closing/place_agreement.h"
#include "loop_closing/place_fuser.h"
#include "map/atlas.h"
#include "map/place_index.h"
#include "optimization/background_slot.h"
#include "optimization/map_bundle.h"

namespace kinemap {

struct LoopCloserOptions {
  LoopDetectorOptions detector;
  LoopVerifierOptions verifier;
  PlaceAgreementOptions agreement;
  EssentialGraphOptions essential_graph;
  PoseGraphOptions pose_graph;
  BundleOptions bundle{5, 5, 1e-5, 0};
  int most_adjusted_keyframes = 1000;  ///< newest, that move in the adjustment of the whole map
  int keyframes_between = 10;          ///< that a map gains after a loop before the next is looked for
  uint64_t seed = 0;
  bool wait = true;  ///< false: what is due but not solved is merged later, at a frame that depends on the machine
  /// Frames until a result is merged, so that a thread has time to compute it: fixed, and by the problem's size.
  int shortest_delay_frames = 3;
  int graph_edges_per_frame = 1000;
  int observations_per_frame = 1000;
};

/// What a call changed.
struct LoopEvents {
  int loops_closed = 0;
  int maps_merged = 0;
  bool map_adjusted = false;
  double background_ms = 0;  ///< processor time of the solving; for reports only
};

/// What a settled loop closer carries from one keyframe to the next.
struct LoopCloserState {
  std::vector<LoopDetector::Group> candidates;
  PlaceAgreement::State agreement;
  int keyframes_since_loop = 0;
};

/// Recognises places in all maps and makes them one: a loop's error is distributed over its map by the essential graph,
/// another map is merged into one; then landmarks are fused and the whole map is adjusted (Mur-Artal, Montiel and
/// Tardos 2015, section VII). What is solved is solved in the background and merged at frames fixed in advance.
class LoopCloser {
 public:
  LoopCloser(const LoopCloserOptions& options, const CameraModel& camera);

  /// Looks for the place of a new keyframe that `places` knows already; may start work in the background.
  void Look(Atlas* atlas, const PlaceIndex& places, KeyframeId keyframe_id, int64_t frame_index);

  /// Whether Merge would change maps at this frame. All else that the background holds must be merged before it.
  bool IsDue(int64_t frame_index) const;
  /// Whether nothing is being solved, so that keyframes may be moved by others.
  bool IsFree() const { return graph_slot_.IsFree() && bundle_slot_.IsFree(); }
  LoopEvents Merge(Atlas* atlas, int64_t frame_index);

  /// Merges all that is pending, whatever frame it is due.
  LoopEvents Settle(Atlas* atlas);

  LoopCloserState state() const { return {detector_.last(), agreement_.state(), keyframes_since_}; }
  void Restore(LoopCloserState state) {
    detector_.Restore(std::move(state.candidates));
    agreement_.Restore(state.agreement);
    keyframes_since_ = state.keyframes_since_loop;
  }

 private:
  /// An essential graph as it was copied and as it is solved; without nodes when a map is to be merged.
  struct GraphProblem {
    PoseGraph before, solved;
  };
  void StartJoining(Atlas* atlas, const VerifiedLoop& loop, int64_t frame_index);
  void Join(Atlas* atlas, int64_t frame_index, LoopEvents* events);
  void StartAdjusting(const SlamMap& map, int64_t frame_index);
  void Adjust(Atlas* atlas, LoopEvents* events);

  LoopCloserOptions options_;
  CameraModel camera_;
  LoopDetector detector_;
  LoopVerifier verifier_;
  PlaceAgreement agreement_;
  PlaceFuser fuser_;
  BackgroundSlot<GraphProblem> graph_slot_;
  BackgroundSlot<BundleProblem> bundle_slot_;
  std::optional<VerifiedLoop> loop_;  // while the graph is being solved
  int keyframes_since_ = 1 << 20;
};

}  // namespace kinemap
