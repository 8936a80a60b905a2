// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "optimization/map_bundle.h"
#include "optimization/relative_velocity_change.h"
#include "synthetic/scene.h"

namespace kinemap {
namespace {

using synthetic::CameraAt;
using synthetic::Scene;
using synthetic::TestCamera;
using synthetic::TestScales;

using Poses = std::array<RigidTransform, 3>;

TEST(RelativeVelocityChange, IsThePartOfTheSpeedInAnyUnit) {
  for (const double unit : {0.01, 1.0, 30.0}) {
    const Eigen::Vector3d origin(4, -1, 3), way(0, 0, unit);
    const Poses faster{CameraAt(origin), CameraAt(origin + way), CameraAt(origin + 2 * way)};
    EXPECT_NEAR(RelativeVelocityChange(faster, 0.5, 0.25).change.norm(), (2 - 1) / std::sqrt(2), 1e-6) << unit;
  }
}

TEST(RelativeVelocityChange, IsNothingInASteadyTurn) {
  const auto on_circle = [](double angle) {
    return CameraAt({10 - 10 * std::cos(angle), 0, 10 * std::sin(angle)}, angle);
  };
  const RigidTransform sideways = CameraAt({2, 0, 8}, 0.4);
  EXPECT_LT(RelativeVelocityChange({on_circle(0.1), on_circle(0.4), on_circle(0.7)}, 1, 1).change.norm(), 1e-9);
  EXPECT_GT(RelativeVelocityChange({on_circle(0.1), on_circle(0.4), sideways}, 1, 1).change.norm(), 0.1);
}

TEST(RelativeVelocityChange, ItsDerivativesAreThoseOfSmallSteps) {
  const Poses poses{CameraAt({0, 0, 0}, 0.1), CameraAt({0.3, 0.1, 0.9}, 0.12), CameraAt({0.5, 0, 2.0}, 0.15)};
  const RelativeVelocityChange at(poses, 0.3, 0.4);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 3; ++i) {
    for (int axis = 0; axis < 6; ++axis) {
      Poses moved = poses;
      moved[i] = poses[i].PerturbedInTarget(kStep * Vector6d::Unit(axis));
      const Eigen::Vector3d slope = (RelativeVelocityChange(moved, 0.3, 0.4).change - at.change) / kStep;
      EXPECT_LT((slope - at.by_pose[i].col(axis)).norm(), 0.01 * at.by_pose[i].norm()) << i << " " << axis;
    }
  }
}

/// A drive along z with a keyframe every half second at these places.
SlamMap Drive(const Scene& scene, const CameraModel& camera, const std::vector<double>& z) {
  std::vector<RigidTransform> cameras;
  cameras.reserve(z.size());
  for (const double each : z) cameras.push_back(CameraAt({0, 0, each}));
  return synthetic::MapOf(scene, camera, cameras, 0, 500'000'000);
}

std::set<KeyframeId> All(const SlamMap& map) {
  const std::vector<KeyframeId> live = map.LiveKeyframes();
  return {live.begin(), live.end()};
}

TEST(VelocityChanges, SlowCamerasMayChangeTheirSpeedByALargerRatio) {
  const Scene scene(100, 5, 20, 60);
  // 4 m/s, then 1 m/s.
  const SlamMap map = Drive(scene, TestCamera(), {0, 2, 4, 6, 6.5, 7, 7.5});
  const std::vector<VelocityChange> changes = CopyBundleProblem(map, All(map)).velocity_changes;
  ASSERT_EQ(changes.size(), 5U);
  const double walk = std::sqrt(1.0 / 3);
  EXPECT_NEAR(changes.front().sigma, walk, 0.02);
  EXPECT_NEAR(changes.back().sigma, walk * 4, 0.4);
}

TEST(VelocityChanges, ToldByNobodyWhoStandsOrWasAwayOrMeasuresDepth) {
  const Scene scene(100, 5, 20, 60);
  const SlamMap stands = Drive(scene, TestCamera(), {0, 2, 4, 4, 4, 6, 8});
  EXPECT_EQ(CopyBundleProblem(stands, All(stands)).velocity_changes.size(), 2U);
  const SlamMap away = synthetic::MapOf(
      scene, TestCamera(), {CameraAt({0, 0, 0}), CameraAt({0, 0, 2}), CameraAt({0, 0, 4})}, 0, 3'000'000'000);
  EXPECT_TRUE(CopyBundleProblem(away, All(away)).velocity_changes.empty());
  SlamMap stereo = Drive(scene, synthetic::TestStereoCamera(), {0, 2, 4, 6});
  stereo.set_metric_scale(true);
  EXPECT_TRUE(CopyBundleProblem(stereo, All(stereo)).velocity_changes.empty());
}

struct Stop {
  double z, time_s, tracked_since_s;
};

/// A keyframe at each stop, without landmarks.
SlamMap MapOfStops(const std::vector<Stop>& stops) {
  Scene scene(100, 5, 20, 60);
  SlamMap map(0, TestScales());
  for (const Stop& stop : stops) {
    Frame frame =
        scene.Observe(TestCamera(), TestScales(), CameraAt({0, 0, stop.z}), static_cast<int64_t>(stop.time_s * 1e9), 0);
    frame.tracked_since_ns = static_cast<int64_t>(stop.tracked_since_s * 1e9);
    map.InsertKeyframe(frame);
  }
  return map;
}

TEST(VelocityChanges, EndWhereALostCameraLeapt) {
  const SlamMap leap = MapOfStops({{0, 0.5, 0}, {2, 1, 0}, {4, 1.5, 0}, {80, 2, 2}, {82, 2.5, 2}, {84, 3, 2}});
  const std::vector<VelocityChange> changes = CopyBundleProblem(leap, All(leap)).velocity_changes;
  ASSERT_EQ(changes.size(), 2U);
  // Nor is the leap taken for the top speed.
  for (const VelocityChange& change : changes) EXPECT_NEAR(change.sigma, std::sqrt(1.0 / 3), 0.02);
}

TEST(VelocityChanges, GoOnWhereALostCameraIsSoonFoundOnItsWay) {
  const SlamMap lost = MapOfStops({{0, 0.5, 0}, {2, 1, 0}, {4, 1.5, 0}, {6, 2, 2}, {8, 2.5, 2}, {10, 3, 2}});
  EXPECT_EQ(CopyBundleProblem(lost, All(lost)).velocity_changes.size(), 4U);
}

TEST(VelocityChanges, DoNotMixDrivesWithTheSameTimes) {
  const SlamMap days =
      MapOfStops({{0, 0.5, 0.5}, {2, 1, 0.5}, {4, 1.5, 0.5}, {11, 0.7, 0.7}, {13, 1.2, 0.7}, {15, 1.7, 0.7}});
  const std::vector<VelocityChange> changes = CopyBundleProblem(days, All(days)).velocity_changes;
  ASSERT_EQ(changes.size(), 2U);
  for (const VelocityChange& change : changes) EXPECT_NEAR(change.earlier_s + change.later_s, 1, 1e-9);
}

TEST(VelocityChanges, HoldTheScaleWhereLandmarksSayLittle) {
  const Scene scene(100, 5, 20, 60);
  const SlamMap map = Drive(scene, TestCamera(), {0, 2, 4, 6, 7});  // the last should be at 8
  BundleProblem problem = CopyBundleProblem(map, {3, 4});
  for (BundleObservation& observation : problem.observations) observation.inverse_variance = 1e-4;
  BundleOptions options{10, 10, 1e-9};
  options.velocity_change = 0.1;
  BundleProblem without = problem;
  SolveBundle(TestCamera(), options, &problem);
  options.velocity_change = 0;
  SolveBundle(TestCamera(), options, &without);
  const auto last = [](const BundleProblem& solved) {
    for (const BundleCamera& camera : solved.cameras) {
      if (camera.keyframe_id == 4) return camera.camera_from_map.Inverse().translation.z();
    }
    return 0.0;
  };
  EXPECT_NEAR(last(problem), 8, 0.3);
  EXPECT_NEAR(last(without), 7, 0.3);
}

}  // namespace
}  // namespace kinemap
