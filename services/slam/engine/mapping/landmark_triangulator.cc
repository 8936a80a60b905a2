// SPDX-License-Identifier: Apache-2.0
#include "mapping/landmark_triangulator.h"

#include <algorithm>
#include <cmath>

#include "geometry/triangulation.h"
#include "map/reprojection_check.h"

namespace kinemap {
namespace {

constexpr double kEpipolarReach = 1.96;  // standard deviations: 95 % of a normal distribution
constexpr double kEpipoleBound = 100;    // squared pixels: near the epipole a line tells nothing
constexpr double kMarginPx = 10;         // beyond both ends and, at the coarsest octave, beside the line
constexpr double kScaleTolerance = 1.5;  // times one octave's factor
// Best over second descriptor distance: what repeats along the line, such as a facade's windows, is left unmatched.
constexpr double kMatchRatio = 0.8;
constexpr double kSameSpotPx = 4;  // keypoints of several octaves at one spot are no rivals
constexpr int kNoRival = 257;      // beyond any distance

bool MayMatch(const FeatureLabel& a, const FeatureLabel& b) {
  if (a.role != b.role) return false;
  return a.role == FeatureRole::kTracked || (a.role == FeatureRole::kMapped && a.object_id == b.object_id);
}

bool IsFree(const Keyframe& keyframe, int keypoint) {
  const FeatureRole role = keyframe.labels[keypoint].role;
  return keyframe.landmark_ids[keypoint] == kNoId && (role == FeatureRole::kTracked || role == FeatureRole::kMapped);
}

std::vector<float> FarthestReaches(const FrameFeatures& features, const PyramidScales& scales) {
  double spread = 1;
  for (const Keypoint& keypoint : features.keypoints) spread = std::max(spread, keypoint.spread);
  std::vector<float> reach_px;
  for (int octave = 0; octave < scales.levels(); ++octave) {
    reach_px.push_back(static_cast<float>(kEpipolarReach * scales.scale(octave) * spread));
  }
  return reach_px;
}

}  // namespace

struct LandmarkTriangulator::Pair {
  const Keyframe& first;
  const Keyframe& second;
  const PyramidScales& scales;
  RigidTransform second_from_first;
  Eigen::Matrix3d fundamental;
  Eigen::Vector2d epipole_px;  // the first camera's centre in the second image
  bool has_epipole;            // false when it lies behind the second camera
  double nearest_depth;
  KeypointGrid free;            // the second image's keypoints that may become landmarks
  std::vector<float> reach_px;  // beside the line, of no keypoint of this octave in the second image more
};

std::vector<LandmarkId> LandmarkTriangulator::Triangulate(SlamMap* map, KeyframeId keyframe_id) const {
  const Keyframe& first = map->keyframe(keyframe_id);
  const double median_depth = map->MedianDepth(keyframe_id);
  std::vector<LandmarkId> made;
  for (const KeyframeId neighbor : map->covisibility().Neighbors(keyframe_id, options_.neighbors)) {
    const Keyframe& second = map->keyframe(neighbor);
    const RigidTransform second_from_first = second.map_from_keyframe.Inverse() * first.map_from_keyframe;
    const double baseline = second_from_first.translation.norm();
    if (baseline < options_.min_baseline_ratio * map->MedianDepth(neighbor)) continue;
    const bool has_epipole = second_from_first.translation.z() > 1e-9 * baseline;
    const Pair pair{first,
                    second,
                    map->scales(),
                    second_from_first,
                    FundamentalFromMotion(second_from_first, camera_.Intrinsics()),
                    has_epipole ? camera_.Project(second_from_first.translation) : Eigen::Vector2d::Zero(),
                    has_epipole,
                    options_.nearest_depth_ratio * median_depth,
                    second.features->grid.Only([&](int j) { return IsFree(second, j); }),
                    FarthestReaches(*second.features, map->scales())};
    const std::vector<LandmarkId> of_pair = TriangulatePair(map, pair);
    made.insert(made.end(), of_pair.begin(), of_pair.end());
  }
  return made;
}

int LandmarkTriangulator::FindMatch(const Pair& pair, int keypoint, const std::vector<bool>& taken) const {
  const Keypoint& point = pair.first.features->keypoints[keypoint];
  const Descriptor& descriptor = pair.first.features->descriptors[keypoint];
  // The point lies on the ray between the nearest depth (in both cameras) and infinity; its image is a segment.
  const Eigen::Vector3d direction = pair.second_from_first.rotation * camera_.Ray(point.pixel_px);
  const Eigen::Vector3d& offset = pair.second_from_first.translation;
  if (direction.z() <= 1e-6) return -1;
  const double nearest = std::max(pair.nearest_depth, (pair.nearest_depth - offset.z()) / direction.z());
  const Eigen::Vector2d near_px = camera_.Project(nearest * direction + offset);
  const Eigen::Vector2d far_px = camera_.Project(direction);
  const Eigen::Vector3d epipolar = pair.fundamental * point.pixel_px.homogeneous();
  const Eigen::Vector3f line = (epipolar / epipolar.head<2>().norm()).cast<float>();
  int best = -1, best_distance = kStrictHammingDistance, rival_distance = kNoRival;
  pair.free.VisitAlong(far_px, near_px, kMarginPx * point.spread, [&](const KeypointGrid::Entry& entry) {
    // Most end here, before anything but the entry itself is read.
    const float off_line = std::abs(line.x() * entry.x_px + line.y() * entry.y_px + line.z());
    if (off_line >= pair.reach_px[entry.octave]) return;
    const Keypoint& candidate = pair.second.features->keypoints[entry.index];
    const double scale = pair.scales.scale(entry.octave) * candidate.spread;
    if (off_line >= kEpipolarReach * scale || taken[entry.index]) return;
    if (!MayMatch(pair.first.labels[keypoint], pair.second.labels[entry.index])) return;
    const int distance = HammingDistance(descriptor, pair.second.features->descriptors[entry.index]);
    const bool elsewhere =
        best < 0 || (candidate.pixel_px - pair.second.features->keypoints[best].pixel_px).norm() > kSameSpotPx;
    if (distance >= best_distance) {
      if (elsewhere) rival_distance = std::min(rival_distance, distance);
      return;
    }
    if (pair.has_epipole && (candidate.pixel_px - pair.epipole_px).squaredNorm() < kEpipoleBound * scale) return;
    if (best >= 0 && elsewhere) rival_distance = best_distance;
    best = entry.index;
    best_distance = distance;
  });
  return best_distance < kMatchRatio * rival_distance ? best : -1;
}

bool LandmarkTriangulator::PointOfMatch(const SlamMap& map, const Pair& pair, int keypoint, int match,
                                        Eigen::Vector3d* in_first) const {
  const PyramidScales& scales = map.scales();
  const Keypoint& a = pair.first.features->keypoints[keypoint];
  const Keypoint& b = pair.second.features->keypoints[match];
  const Eigen::Vector3d ray_1 = camera_.Ray(a.pixel_px), ray_2 = camera_.Ray(b.pixel_px);
  const double cosine = (pair.second_from_first.rotation * ray_1).normalized().dot(ray_2.normalized());
  if (cosine <= 0 || cosine >= options_.max_parallax_cosine) return false;
  const Eigen::Vector3d point = TriangulateTwoRays(pair.second_from_first, ray_1, ray_2);
  if (!point.allFinite() || point.z() <= 0) return false;
  const Eigen::Vector3d in_second = pair.second_from_first * point;
  if (in_second.z() <= 0) return false;
  if (!Reprojects(map, camera_, point, a) || !Reprojects(map, camera_, in_second, b)) return false;
  // The ratio of the distances must be that of the octaves.
  const double distance_ratio = in_second.norm() / point.norm();
  const double octave_ratio = scales.scale(a.octave) / scales.scale(b.octave);
  const double tolerance = kScaleTolerance * (scales.levels() > 1 ? scales.scale(1) : 1.2);
  if (distance_ratio * tolerance < octave_ratio || distance_ratio > octave_ratio * tolerance) return false;
  *in_first = point;
  return true;
}

std::vector<LandmarkId> LandmarkTriangulator::TriangulatePair(SlamMap* map, const Pair& pair) const {
  std::vector<bool> taken(pair.second.features->size(), false);
  std::vector<LandmarkId> made;
  for (int i = 0; i < pair.first.features->size(); ++i) {
    if (!IsFree(pair.first, i)) continue;
    const int match = FindMatch(pair, i, taken);
    Eigen::Vector3d in_first;
    if (match < 0 || !PointOfMatch(*map, pair, i, match, &in_first)) continue;
    taken[match] = true;
    Landmark& landmark =
        map->CreateLandmark(pair.first.map_from_keyframe * in_first, pair.first.id, pair.first.labels[i]);
    map->Observe(&landmark, pair.first.id, i);
    map->Observe(&landmark, pair.second.id, match);
    map->UpdateDescriptor(&landmark);
    map->UpdateViewRange(&landmark);
    made.push_back(landmark.id);
  }
  return made;
}

}  // namespace kinemap
