// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <set>
#include <vector>

#include "features/pyramid_scales.h"
#include "map/covisibility_graph.h"
#include "map/frame.h"
#include "map/id_table.h"
#include "map/ids.h"
#include "map/keyframe.h"
#include "map/landmark.h"

namespace kinemap {

/// What changed since it was last asked. Ids ascend.
struct MapChanges {
  std::vector<KeyframeId> keyframes;
  std::vector<LandmarkId> landmarks;
  std::vector<LandmarkId> removed_landmarks;
};

/// Keyframes that came and went since it was last asked, in that order.
struct KeyframeTurnover {
  std::vector<KeyframeId> inserted, culled;
};

/// Keyframes, landmarks and what ties them together. Landmarks sit in the frame of their anchor keyframe, so that
/// moving a keyframe moves them too. One thread at a time.
class SlamMap {
 public:
  SlamMap(int64_t map_id, const PyramidScales& scales);

  int64_t map_id() const { return map_id_; }
  /// Whether map units are metres.
  bool metric_scale() const { return metric_scale_; }
  void set_metric_scale(bool metric) { metric_scale_ = metric; }
  const PyramidScales& scales() const { return scales_; }
  const CovisibilityGraph& covisibility() const { return covisibility_; }

  /// From now on new ids count up from number << 32, a block that nothing else takes ids from.
  void set_id_block(int64_t number) { id_block_ = number; }

  // Keyframes.
  /// Takes over the frame's pose, features and matches, and observes the matched landmarks.
  Keyframe& InsertKeyframe(const Frame& frame);
  const Keyframe& keyframe(KeyframeId id) const { return *keyframes_.Find(id); }
  /// Null when the keyframe is not in this map.
  const Keyframe* FindKeyframe(KeyframeId id) const { return keyframes_.Find(id); }
  /// The keyframe that holds the map's origin.
  KeyframeId first_keyframe_id() const { return map_id_ << 32; }
  /// The keyframe inserted last.
  KeyframeId last_keyframe_id() const { return last_keyframe_id_; }
  int keyframe_count() const { return keyframe_count_; }
  int live_keyframe_count() const { return live_keyframes_; }
  std::vector<KeyframeId> LiveKeyframes() const;
  /// The keyframe itself, or the first of its parents that was not culled.
  KeyframeId LiveKeyframe(KeyframeId id) const;
  /// Also of a culled keyframe, through its parents.
  RigidTransform MapFromKeyframe(KeyframeId id) const { return MapFromAnchor(id).WithoutScale(); }
  /// What turns positions of landmarks anchored at a keyframe, culled or not, into positions in the map.
  SimilarityTransform MapFromAnchor(KeyframeId id) const;
  /// The scale stays.
  void SetKeyframePose(KeyframeId id, const RigidTransform& map_from_keyframe);
  /// Of a live keyframe. Landmarks anchored here move along; those it observes need UpdateViewRange after it.
  void SetKeyframePose(KeyframeId id, const SimilarityTransform& map_from_anchor);
  /// Pose of a camera by a keyframe, in the units of what is anchored there: it follows whatever becomes of the map.
  RigidTransform CameraFromReference(const RigidTransform& camera_from_map, KeyframeId reference_id) const;
  RigidTransform CameraFromMap(const RigidTransform& camera_from_reference, KeyframeId reference_id) const;
  /// Moves the live keyframes' features to where another model of the lens undistorts them to.
  void UndistortFeatures(const CameraModel& camera);
  /// Ties two keyframes that a recognised place shows to be neighbours.
  void AddLoopEdge(KeyframeId a, KeyframeId b);
  /// Drops features and observations; the pose stays, relative to the keyframe that shares most with it, where the
  /// landmarks anchored here go too. Landmarks left with fewer than two observations are removed.
  void CullKeyframe(KeyframeId id);
  /// Recounts the landmarks shared with others; only those that may constrain poses count.
  void UpdateCovisibility(KeyframeId id);

  // Landmarks.
  Landmark& CreateLandmark(const Eigen::Vector3d& position_in_map, KeyframeId anchor_id, const FeatureLabel& label);
  /// Null when it was removed; the survivor when it was fused into another.
  Landmark* FindLandmark(LandmarkId id);
  const Landmark* FindLandmark(LandmarkId id) const { return const_cast<SlamMap*>(this)->FindLandmark(id); }
  int landmark_count() const { return live_landmarks_; }
  /// Ids of all landmarks that were not removed, ascending.
  std::vector<LandmarkId> LiveLandmarks() const;
  /// Landmarks that are, or once were, of an object, removed ones among them; in the order in which they became so.
  const std::vector<LandmarkId>& LandmarksOfObject(uint32_t object_id) const;
  Eigen::Vector3d PositionInMap(const Landmark& landmark) const;
  void SetPositionInMap(Landmark* landmark, const Eigen::Vector3d& position_in_map);
  void Observe(Landmark* landmark, KeyframeId keyframe_id, int keypoint);
  /// Removes the landmark with its last but one observation.
  void EraseObservation(Landmark* landmark, KeyframeId keyframe_id);
  void RemoveLandmark(LandmarkId id);
  /// All observations of `from` become those of `into`; `from` is removed.
  void FuseLandmarks(LandmarkId from, LandmarkId into);
  /// Descriptor, from the observations.
  void UpdateDescriptor(Landmark* landmark);
  /// Viewing direction and range of distances, from the observations and poses.
  void UpdateViewRange(Landmark* landmark);
  /// Object by the majority of its observations, the newest deciding a tie; state as that object's was seen last.
  void UpdateLabel(Landmark* landmark);
  void MarkChanged(const Landmark& landmark) { changed_landmarks_.insert(landmark.id); }

  /// Images in which keyframes see a landmark; a measured depth counts as a second one where the map is metric.
  int CountViews(const Landmark& landmark) const;
  /// Trackable landmarks of a keyframe that are seen in at least `min_views` images.
  int CountTracked(KeyframeId id, int min_views) const;
  /// Median depth of a keyframe's trackable landmarks along its optical axis; 0 when it has none.
  double MedianDepth(KeyframeId id) const;

  MapChanges TakeChanges();
  KeyframeTurnover TakeTurnover();

  /// Takes over all of another map, whose ids stay what they are.
  void Absorb(SlamMap&& other, const SimilarityTransform& this_from_other);

 private:
  friend class MapCodec;  // reads and writes every member
  Keyframe& mutable_keyframe(KeyframeId id) { return *keyframes_.Find(id); }
  void Reanchor(Landmark* landmark, KeyframeId anchor_id);
  void SetObject(Landmark* landmark, const FeatureLabel& label);

  int64_t map_id_, id_block_;
  PyramidScales scales_;
  CovisibilityGraph covisibility_;
  IdTable<Keyframe> keyframes_;
  IdTable<Landmark> landmarks_;
  std::map<LandmarkId, LandmarkId> fused_into_;
  std::map<uint32_t, std::vector<LandmarkId>> landmarks_of_object_;
  KeyframeId last_keyframe_id_ = kNoId;
  KeyframeTurnover turnover_;
  bool metric_scale_ = false;
  int keyframe_count_ = 0, live_keyframes_ = 0, live_landmarks_ = 0;
  std::set<KeyframeId> changed_keyframes_;
  std::set<LandmarkId> changed_landmarks_, removed_landmarks_, reported_landmarks_;
};

}  // namespace kinemap
