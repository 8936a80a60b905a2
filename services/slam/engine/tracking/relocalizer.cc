// SPDX-License-Identifier: Apache-2.0
#include "tracking/relocalizer.h"

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

#include "tracking/frame_matcher.h"

namespace kinemap {
namespace {

constexpr int kNearest = 3, kInTurn = 2;
constexpr double kMatchRatio = 0.75;
constexpr int kLeastMatches = 15;
constexpr int kLeastPnpInliers = 10;
constexpr int kLeastInliers = 50;
constexpr int kPnpIterations = 200;
constexpr float kPnpErrorPx = 4.0f;

}  // namespace

std::vector<KeyframeId> Relocalizer::Candidates(const SlamMap& map, const Eigen::Vector3d& last_center_in_map,
                                                int lost_frames) const {
  const std::vector<KeyframeId> live = map.LiveKeyframes();
  std::vector<std::pair<double, KeyframeId>> ranked;
  for (const KeyframeId id : live) {
    ranked.emplace_back((map.keyframe(id).map_from_keyframe.translation - last_center_in_map).norm(), id);
  }
  std::sort(ranked.begin(), ranked.end());
  std::vector<KeyframeId> candidates;
  for (size_t i = 0; i < ranked.size() && i < kNearest; ++i) candidates.push_back(ranked[i].second);
  for (int i = 0; i < kInTurn; ++i) {
    const KeyframeId id = live[(static_cast<size_t>(lost_frames) * kInTurn + i) % live.size()];
    if (std::find(candidates.begin(), candidates.end(), id) == candidates.end()) candidates.push_back(id);
  }
  return candidates;
}

bool Relocalizer::SolvePnp(const SlamMap& map, Frame* frame) const {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  std::vector<int> keypoints;
  for (int i = 0; i < frame->size(); ++i) {
    const Landmark* landmark = map.FindLandmark(frame->landmark_ids[i]);
    if (landmark == nullptr) continue;
    const Eigen::Vector3d position = map.PositionInMap(*landmark);
    const Eigen::Vector2d& pixel = frame->features->keypoints[i].pixel_px;
    points.emplace_back(position.x(), position.y(), position.z());
    pixels.emplace_back(pixel.x(), pixel.y());
    keypoints.push_back(i);
  }
  cv::Mat intrinsics, rotation_vector, translation, rotation;
  cv::eigen2cv(camera_.Intrinsics(), intrinsics);
  std::vector<int> inliers;
  if (!cv::solvePnPRansac(points, pixels, intrinsics, cv::noArray(), rotation_vector, translation, false,
                          kPnpIterations, kPnpErrorPx, 0.99, inliers, cv::SOLVEPNP_EPNP)) {
    return false;
  }
  if (static_cast<int>(inliers.size()) < kLeastPnpInliers) return false;
  cv::Rodrigues(rotation_vector, rotation);
  Eigen::Matrix3d rotation_matrix;
  Eigen::Vector3d translation_vector;
  cv::cv2eigen(rotation, rotation_matrix);
  cv::cv2eigen(translation, translation_vector);
  frame->camera_from_map = RigidTransform(Eigen::Quaterniond(rotation_matrix), translation_vector);
  std::vector<bool> keep(keypoints.size(), false);
  for (const int index : inliers) keep[index] = true;
  for (size_t i = 0; i < keypoints.size(); ++i) {
    if (!keep[i]) frame->landmark_ids[keypoints[i]] = kNoId;
  }
  return true;
}

bool Relocalizer::TryKeyframe(const SlamMap& map, KeyframeId keyframe_id, Frame* frame) const {
  if (MatchKeyframe(map, keyframe_id, kMatchRatio, frame) < kLeastMatches) return false;
  if (!SolvePnp(map, frame)) return false;
  if (solver_.Solve(map, frame).inliers < kLeastPnpInliers) return false;
  ProjectKeyframe(map, camera_, keyframe_id, 10.0, kMaxHammingDistance, frame);
  int inliers = solver_.Solve(map, frame).inliers;
  if (inliers >= kLeastPnpInliers && inliers < kLeastInliers) {
    ProjectKeyframe(map, camera_, keyframe_id, 3.0, kMaxHammingDistance, frame);
    inliers = solver_.Solve(map, frame).inliers;
  }
  frame->reference_keyframe_id = keyframe_id;
  return inliers >= kLeastInliers;
}

bool Relocalizer::Relocalize(const SlamMap& map, const Eigen::Vector3d& last_center_in_map, int lost_frames,
                             Frame* frame) const {
  for (const KeyframeId candidate : Candidates(map, last_center_in_map, lost_frames)) {
    if (TryKeyframe(map, candidate, frame)) return true;
  }
  frame->ForgetMatches();
  return false;
}

}  // namespace kinemap
