// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "map/depth_error.h"
#include "synthetic/scene.h"

namespace kinemap {
namespace {

using synthetic::CameraAt;
using synthetic::MapOf;
using synthetic::Scene;

constexpr double kErrorRad = 0.004;

const Landmark& FirstOf(const SlamMap& map) { return *map.FindLandmark(map.LiveLandmarks().front()); }

TEST(DepthError, IsALengthAlongTheRayThatParallaxMakesShort) {
  const Scene scene(1, 0.1, 10, 10.1);
  const SlamMap narrow = MapOf(scene, synthetic::TestCamera(), {CameraAt({0, 0, 0}), CameraAt({0.2, 0, 0})});
  const SlamMap wide = MapOf(scene, synthetic::TestCamera(), {CameraAt({0, 0, 0}), CameraAt({2, 0, 0})});
  const Eigen::Vector3d of_narrow = DepthError(narrow, FirstOf(narrow), {0, 0, 0}, kErrorRad);
  const Eigen::Vector3d of_wide = DepthError(wide, FirstOf(wide), {0, 0, 0}, kErrorRad);
  EXPECT_NEAR(of_narrow.norm(), 10 * kErrorRad / 0.02, 0.05);
  EXPECT_NEAR(of_wide.norm(), 10 * kErrorRad / 0.2, 0.02);
  EXPECT_LT(of_narrow.normalized().cross(scene.points()[0].normalized()).norm(), 1e-6);
}

TEST(DepthError, IsAlongTheRayOfTheNearestView) {
  const Scene scene(1, 0.1, 10, 10.1);
  const SlamMap map = MapOf(scene, synthetic::TestCamera(), {CameraAt({0, 0, 0}), CameraAt({2, 0, 0})});
  const Eigen::Vector3d beside_second = DepthError(map, FirstOf(map), {2.5, 0, 0}, kErrorRad);
  const Eigen::Vector3d ray = scene.points()[0] - Eigen::Vector3d(2, 0, 0);
  EXPECT_LT(beside_second.normalized().cross(ray.normalized()).norm(), 1e-6);
}

TEST(DepthError, IsNoMoreThanTheDistance) {
  const Scene scene(1, 0.1, 10, 10.1);
  const SlamMap map = MapOf(scene, synthetic::TestCamera(), {CameraAt({0, 0, 0}), CameraAt({0, 0, 0})});
  EXPECT_NEAR(DepthError(map, FirstOf(map), {0, 0, 0}, kErrorRad).norm(), scene.points()[0].norm(), 1e-6);
}

TEST(DepthError, IsNoneOfMeasuredDepth) {
  const Scene scene(1, 0.1, 10, 10.1);
  SlamMap map = MapOf(scene, synthetic::TestStereoCamera(), {CameraAt({0, 0, 0}), CameraAt({0.2, 0, 0})});
  map.set_metric_scale(true);
  EXPECT_EQ(DepthError(map, FirstOf(map), {0, 0, 0}, kErrorRad), Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace kinemap
