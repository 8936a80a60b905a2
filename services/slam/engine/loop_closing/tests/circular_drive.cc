// SPDX-License-Identifier: Apache-2.0
#include "loop_closing/tests/circular_drive.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "geometry/sim3_alignment.h"

namespace kinemap::synthetic {
namespace {

constexpr int kPoints = 2400;
constexpr double kPi = 3.14159265358979;
constexpr double kRadius = 20, kSight = 12;
constexpr uint8_t kWords = 200;

}  // namespace

CircularDrive::CircularDrive() : scene_(kPoints, 1, 5, 10) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> angle(0, 2 * kPi), height(-2.5, 2.5), depth(0, 3);
  for (size_t i = 0; i < scene_.points().size(); ++i) {
    const double a = angle(random), radius = kRadius + (i % 2 == 0 ? 3 + depth(random) : -3 - depth(random));
    scene_.points()[i] = {radius * std::cos(a), height(random), radius * std::sin(a)};
  }
}

RigidTransform CircularDrive::WorldFromCamera(int step) const {
  const double angle = 2 * kPi * step / kStepsARound;
  const Eigen::Vector3d center(kRadius * std::cos(angle), 0, kRadius * std::sin(angle));
  return {Eigen::Quaterniond(Eigen::AngleAxisd(-angle, Eigen::Vector3d::UnitY())), center};
}

Frame CircularDrive::Observe(int step, std::vector<int>* points) const {
  const RigidTransform camera_from_world = WorldFromCamera(step).Inverse();
  Scene near = scene_;
  for (Eigen::Vector3d& point : near.points()) {
    const Eigen::Vector3d in_camera = camera_from_world * point;
    if (in_camera.norm() > kSight) point = camera_from_world.Inverse() * Eigen::Vector3d(0, 0, -1);
  }
  const Frame frame = near.Observe(TestCamera(), TestScales(), camera_from_world, (step + 1) * 100);
  *points = near.observed_points();
  return frame;
}

std::unique_ptr<SlamMap> CircularDrive::Map(int64_t map_id, int begin, int end, const SimilarityTransform& start,
                                            const SimilarityTransform& drift) const {
  struct Sight {
    KeyframeId keyframe_id;
    int keypoint;
    LandmarkId landmark_id;
  };
  auto map = std::make_unique<SlamMap>(map_id, TestScales());
  std::map<int, Sight> last_round;
  SimilarityTransform map_from_camera = start;
  for (int step = begin; step < end; ++step) {
    std::vector<int> points;
    Frame frame = Observe(step, &points);
    const SimilarityTransform map_from_world = map_from_camera * SimilarityTransform(frame.camera_from_map);
    frame.camera_from_map = map_from_camera.WithoutScale().Inverse();
    const KeyframeId id = map->InsertKeyframe(frame).id;
    std::map<int, Sight> seen;
    for (int i = 0; i < frame.size(); ++i) {
      Sight sight{id, i, kNoId};
      const auto before = last_round.find(points[i]);
      if (before != last_round.end()) {
        sight.landmark_id = before->second.landmark_id;
        if (sight.landmark_id == kNoId) {
          Landmark& made =
              map->CreateLandmark(map_from_world * scene_.points()[points[i]], before->second.keyframe_id, {});
          map->Observe(&made, before->second.keyframe_id, before->second.keypoint);
          sight.landmark_id = made.id;
        }
        map->Observe(map->FindLandmark(sight.landmark_id), id, i);
      }
      seen[points[i]] = sight;
    }
    last_round = std::move(seen);
    map_from_camera =
        map_from_camera * SimilarityTransform(WorldFromCamera(step).Inverse() * WorldFromCamera(step + 1)) * drift;
  }
  for (const LandmarkId id : map->LiveLandmarks()) {
    map->UpdateDescriptor(map->FindLandmark(id));
    map->UpdateViewRange(map->FindLandmark(id));
  }
  for (const KeyframeId id : map->LiveKeyframes()) map->UpdateCovisibility(id);
  return map;
}

CircularDrive CircularDrive::Shuffled() const {
  CircularDrive other = *this;
  std::mt19937 random(9);
  // Only among near neighbours, so that each place still shows its own words.
  std::vector<Eigen::Vector3d>& points = other.scene_.points();
  std::vector<size_t> order(points.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return std::atan2(points[a].z(), points[a].x()) < std::atan2(points[b].z(), points[b].x());
  });
  constexpr size_t kGroup = 100;
  for (size_t first = 0; first + kGroup <= order.size(); first += kGroup) {
    for (size_t i = kGroup - 1; i > 0; --i)
      std::swap(points[order[first + i]], points[order[first + random() % (i + 1)]]);
  }
  return other;
}

PlaceIndex CircularDrive::EmptyIndex() const {
  std::mt19937_64 bits(3);
  Vocabulary::Tree tree;
  tree.child_counts.assign(kWords + 1, 0);
  tree.child_counts[0] = kWords;
  tree.word_weights.assign(kWords, 1);
  for (int i = 0; i <= kWords; ++i) tree.centers.push_back({bits(), bits(), bits(), bits()});
  return PlaceIndex(std::make_shared<const Vocabulary>(std::move(tree)));
}

double CircularDrive::Error(const SlamMap& map, int begin) const {
  std::vector<Eigen::Vector3d> estimated, truth;
  for (const KeyframeId id : map.LiveKeyframes()) {
    estimated.push_back(map.MapFromKeyframe(id).translation);
    truth.push_back(WorldFromCamera(begin + static_cast<int>(id - map.first_keyframe_id())).translation);
  }
  const SimilarityTransform aligned = *AlignPoints(estimated, truth, false);
  double sum = 0;
  for (size_t i = 0; i < truth.size(); ++i) sum += (aligned * estimated[i] - truth[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(truth.size()));
}

}  // namespace kinemap::synthetic
