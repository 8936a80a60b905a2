// SPDX-License-Identifier: Apache-2.0
#include "loop_closing/loop_closer.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "loop_closing/map_correction.h"
#include "loop_closing/map_merger.h"

namespace kinemap {

namespace {

constexpr int kLeastDepths = 100;

/// Stereo and depth give the units of a map, so that they are the same at both ends of a loop.
bool MeasuresDepth(const Keyframe& keyframe) {
  const std::vector<Keypoint>& keypoints = keyframe.features->keypoints;
  return std::count_if(keypoints.begin(), keypoints.end(),
                       [](const Keypoint& keypoint) { return std::isfinite(keypoint.right_x_px); }) >= kLeastDepths;
}

}  // namespace

LoopCloser::LoopCloser(const LoopCloserOptions& options, const CameraModel& camera)
    : options_(options),
      camera_(camera),
      detector_(options.detector),
      verifier_(options.verifier, camera),
      agreement_(options.agreement),
      fuser_(camera) {}

void LoopCloser::Look(Atlas* atlas, const PlaceIndex& places, KeyframeId keyframe_id, int64_t frame_index) {
  ++keyframes_since_;
  if (loop_ || keyframes_since_ < options_.keyframes_between) return;
  const SlamMap* map = atlas->MapOf(keyframe_id);
  for (const KeyframeId candidate : detector_.Detect(atlas, places, keyframe_id)) {
    RandomEngine random(options_.seed, map->keyframe(keyframe_id).timestamp_ns);
    const bool fixed_scale =
        MeasuresDepth(map->keyframe(keyframe_id)) && MeasuresDepth(atlas->MapOf(candidate)->keyframe(candidate));
    const auto loop = verifier_.Verify(atlas, places, keyframe_id, candidate, fixed_scale, random);
    if (!loop) continue;
    if (!agreement_.Takes(atlas, *loop)) continue;
    StartJoining(atlas, *loop, frame_index);
    return;
  }
}

void LoopCloser::StartJoining(Atlas* atlas, const VerifiedLoop& loop, int64_t frame_index) {
  // Whatever is being adjusted is about a map that will not be the same.
  bundle_slot_.Cancel();
  loop_ = loop;
  detector_.Forget();
  agreement_.Forget();
  PoseGraphOptions options = options_.pose_graph;
  options.fixed_scale = loop.fixed_scale;
  GraphProblem problem;
  const SlamMap* map = atlas->MapOf(loop.keyframe_id);
  if (map == atlas->MapOf(loop.matched_id)) {
    problem.before = problem.solved = CopyEssentialGraph(options_.essential_graph, *map, loop);
  }
  const int64_t delay = options_.shortest_delay_frames +
                        static_cast<int64_t>(problem.before.edges.size()) / options_.graph_edges_per_frame;
  graph_slot_.Start(
      std::move(problem),
      [options](const std::atomic<bool>&, GraphProblem* graph) {
        if (!graph->solved.nodes.empty()) SolvePoseGraph(options, &graph->solved);
      },
      frame_index + delay);
}

bool LoopCloser::IsDue(int64_t frame_index) const {
  return graph_slot_.IsDue(frame_index, options_.wait) || bundle_slot_.IsDue(frame_index, options_.wait);
}

LoopEvents LoopCloser::Merge(Atlas* atlas, int64_t frame_index) {
  LoopEvents events;
  if (bundle_slot_.IsDue(frame_index, options_.wait)) Adjust(atlas, &events);
  if (graph_slot_.IsDue(frame_index, options_.wait)) Join(atlas, frame_index, &events);
  return events;
}

LoopEvents LoopCloser::Settle(Atlas* atlas) {
  LoopEvents events;
  if (!bundle_slot_.IsFree()) Adjust(atlas, &events);
  if (!graph_slot_.IsFree()) Join(atlas, 0, &events);
  if (!bundle_slot_.IsFree()) Adjust(atlas, &events);
  return events;
}

void LoopCloser::Join(Atlas* atlas, int64_t frame_index, LoopEvents* events) {
  const GraphProblem problem = graph_slot_.Take();
  const VerifiedLoop loop = *loop_;
  loop_.reset();
  events->background_ms += graph_slot_.solve_ms();
  if (problem.solved.nodes.empty()) {
    ++events->maps_merged;
  } else {
    ApplyCorrections(CorrectionsOf(problem.before, problem.solved), atlas->MapOf(loop.keyframe_id));
    ++events->loops_closed;
  }
  SlamMap& map = MapMerger::Merge(atlas, loop);
  fuser_.Fuse(&map, loop);
  keyframes_since_ = 0;
  StartAdjusting(map, frame_index);
}

void LoopCloser::StartAdjusting(const SlamMap& map, int64_t frame_index) {
  const std::vector<KeyframeId> live = map.LiveKeyframes();
  const size_t left_out = live.size() - std::min(live.size(), static_cast<size_t>(options_.most_adjusted_keyframes));
  BundleProblem problem = CopyBundleProblem(map, std::set<KeyframeId>(live.begin() + left_out, live.end()));
  const int64_t delay = options_.shortest_delay_frames +
                        static_cast<int64_t>(problem.observations.size()) / options_.observations_per_frame;
  bundle_slot_.Start(
      std::move(problem),
      [camera = camera_, options = options_.bundle](const std::atomic<bool>& cancelled, BundleProblem* bundle) {
        SolveBundle(camera, options, bundle, &cancelled);
      },
      frame_index + delay);
}

void LoopCloser::Adjust(Atlas* atlas, LoopEvents* events) {
  const BundleProblem solved = bundle_slot_.Take();
  events->background_ms += bundle_slot_.solve_ms();
  events->map_adjusted = true;
  ApplyAdjustment(solved, atlas->MapOf(solved.cameras.front().keyframe_id));
}

}  // namespace kinemap
