// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <future>
#include <optional>
#include <utility>
#include <vector>

#include "mapping/final_adjuster.h"
#include "mapping/keyframe_culler.h"
#include "mapping/landmark_culler.h"
#include "mapping/landmark_fuser.h"
#include "mapping/landmark_triangulator.h"
#include "mapping/local_bundle_adjuster.h"
#include "mapping/measured_landmark_maker.h"
#include "mapping/merge_slot.h"
#include "mapping/moving_landmark_placer.h"

namespace kinemap {

struct LocalMapperOptions {
  TriangulatorOptions triangulator;
  FuserOptions fuser;
  LocalBundleOptions bundle;
  int merge_delay_frames = 2;  ///< bundle adjustment of the keyframe at frame k is merged at frame k + this
  FinalAdjusterOptions final_adjustment;
};

/// Everything that happens around a keyframe, in the background: culling, triangulation and fusion until the next frame
/// is tracked, bundle adjustment on a copy, merged a fixed number of frames later.
class LocalMapper {
 public:
  LocalMapper(const LocalMapperOptions& options, const CameraModel& camera);

  bool IsFree() const { return slot_.IsFree(); }

  /// Makes a keyframe of the frame, around which there is then something to map. Returns its id; `unplaced` gets the
  /// moving features without a place.
  KeyframeId Insert(SlamMap* map, const Frame& frame, int64_t frame_index, int* unplaced);

  /// Lets another thread map around the keyframe inserted last, unless that has begun or there is none. From here to
  /// WaitForMapping nobody else may touch the map.
  void StartMapping();

  /// Returns the map when what was started has ended; throws what it threw.
  void WaitForMapping();

  /// All that there is to map around the newest keyframe is mapped after this; the calls below begin with it.
  void FinishMapping();

  /// Merges the background's solution when its frame has come, and culls redundant keyframes.
  void MergeIfDue(SlamMap* map, int64_t frame_index);

  /// Merges what is pending, whatever frame it is due: nothing else may move many keyframes before.
  void Settle(SlamMap* map);

  /// Settles, and is done with this map until a keyframe comes.
  void Leave(SlamMap* map);

  /// All that a settled mapper carries over to the next keyframe.
  const LandmarkCuller::OnTrial& on_trial() const { return landmark_culler_.on_trial(); }
  void Restore(LandmarkCuller::OnTrial on_trial) { landmark_culler_.Replace(std::move(on_trial)); }

  /// Merges what is pending, whatever frame it is due, and adjusts the whole map, or its newest part, once more.
  /// Returns the radial distortion that was believed, 0 for none.
  double Finish(SlamMap* map, double known_radial);

 private:
  void Merge(SlamMap* map);
  void MapAround(SlamMap* map, KeyframeId keyframe_id, int64_t due_frame);

  /// What StartMapping is to do.
  struct Waiting {
    SlamMap* map;
    KeyframeId keyframe_id;
    int64_t due_frame;
  };

  LocalMapperOptions options_;
  CameraModel camera_;
  MeasuredLandmarkMaker measured_maker_;
  LandmarkTriangulator triangulator_;
  LandmarkFuser fuser_;
  LandmarkCuller landmark_culler_;
  KeyframeCuller keyframe_culler_;
  LocalBundleAdjuster bundle_adjuster_;
  FinalAdjuster final_adjuster_;
  MovingLandmarkPlacer moving_placer_;
  MergeSlot slot_;
  KeyframeId newest_ = kNoId;
  std::optional<Waiting> waiting_;
  std::future<void> running_;  // last, so that it ends before what it uses
};

}  // namespace kinemap
