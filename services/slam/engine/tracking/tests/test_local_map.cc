// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "synthetic/scene.h"
#include "tracking/local_map_tracker.h"

namespace kinemap {
namespace {

using synthetic::CameraAt;
using synthetic::MapOf;
using synthetic::Scene;
using synthetic::TestCamera;
using synthetic::TestScales;

constexpr int kPoints = 400, kEach = 6;

/// A map of two keyframes and a frame of the second's pose that is matched with nothing but the few points that look
/// as mapped but for `bits`; everything else shows something unlike.
class LocalMap : public testing::Test {
 protected:
  Frame FewLookAlike(int bits) {
    Frame frame = scene_.Observe(TestCamera(), TestScales(), CameraAt({0.5, 0, 0}), 1000);
    auto features = std::make_shared<FrameFeatures>(*frame.features);
    for (int i = 0; i < features->size(); ++i) {
      const bool alike = i % kEach == 0;
      for (int bit = 0; bit < (alike ? bits : 128); ++bit) features->descriptors[i][bit / 64] ^= 1ull << (bit % 64);
      if (alike) frame.landmark_ids[i] = map_.keyframe(map_.last_keyframe_id()).landmark_ids[i];
    }
    frame.features = features;
    return frame;
  }

  Scene scene_{kPoints, 4, 6, 16};
  SlamMap map_ = MapOf(scene_, TestCamera(), {CameraAt({0, 0, 0}), CameraAt({0.5, 0, 0})});
  LocalMapTracker tracker_{TestCamera()};
};

TEST_F(LocalMap, BelievesInFewLandmarksThatLookAsMapped) {
  Frame frame = FewLookAlike(50);
  EXPECT_GT(tracker_.Track(&map_, 1, &frame).inliers, frame.size() / kEach - 5);
}

TEST_F(LocalMap, DoesNotBelieveInFewLandmarksThatHardlyLookAsMapped) {
  Frame frame = FewLookAlike(85);
  const LandmarkId first = frame.landmark_ids[0];
  const int visible = map_.FindLandmark(first)->visible;
  EXPECT_EQ(tracker_.Track(&map_, 1, &frame).inliers, 0);
  EXPECT_EQ(std::count(frame.landmark_ids.begin(), frame.landmark_ids.end(), kNoId), frame.size());
  EXPECT_EQ(map_.FindLandmark(first)->visible, visible) << "nothing is learned from a pose that is not one";
}

}  // namespace
}  // namespace kinemap
