// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "features/vocabulary_trainer.h"
#include "synthetic/scene.h"
#include "tracking/relocalizer.h"

namespace kinemap {
namespace {

using synthetic::CameraAt;
using synthetic::MapOf;
using synthetic::Scene;
using synthetic::TestCamera;
using synthetic::TestScales;

/// Two rooms, 100 m apart, in one map; keyframes 0 to 2 stand in the first, 3 to 5 in the second.
class Relocalization : public ::testing::Test {
 protected:
  Relocalization() : scene_(800, 4, 6, 16), map_(0, TestScales()), places_(nullptr) {
    for (size_t i = 400; i < scene_.points().size(); ++i) scene_.points()[i].x() += 100;
    map_ = MapOf(scene_, TestCamera(),
                 {CameraAt({0, 0, 0}), CameraAt({0.4, 0, 0}), CameraAt({0.8, 0, 0}), CameraAt({100, 0, 0}),
                  CameraAt({100.4, 0, 0}), CameraAt({100.8, 0, 0})});
    std::vector<Descriptor> descriptors;
    std::vector<int> image_of_descriptor;
    for (const KeyframeId id : map_.LiveKeyframes()) {
      for (const Descriptor& descriptor : map_.keyframe(id).features->descriptors) {
        descriptors.push_back(descriptor);
        image_of_descriptor.push_back(static_cast<int>(id));
      }
    }
    VocabularyTrainerOptions options;
    options.depth = 3;
    options.least_of_node = 2;
    places_ =
        PlaceIndex(std::make_shared<Vocabulary>(VocabularyTrainer(options).Train(descriptors, image_of_descriptor)));
    places_.Follow(&map_);
  }

  Frame Seen(const Eigen::Vector3d& center, const std::function<FeatureLabel(int)>& label = nullptr) const {
    Frame frame = scene_.Observe(TestCamera(), TestScales(), CameraAt(center), 77, 0.3, label);
    frame.camera_from_map = RigidTransform();
    return frame;
  }

  static double Error(const Frame& frame, const Eigen::Vector3d& center) {
    return (frame.camera_from_map.Inverse().translation - center).norm();
  }

  Scene scene_;
  SlamMap map_;
  PlaceIndex places_;
};

TEST_F(Relocalization, FindsThePlaceHoweverFarItIs) {
  Relocalizer relocalizer({}, TestCamera(), &places_);
  for (const Eigen::Vector3d& center : {Eigen::Vector3d(0.2, 0.3, 0.5), Eigen::Vector3d(100.6, -0.3, 0.5)}) {
    Frame frame = Seen(center);
    ASSERT_TRUE(relocalizer.Relocalize(map_, {0, 0, 0}, 0, &frame));
    EXPECT_LT(Error(frame, center), 0.05);
    EXPECT_EQ(frame.reference_keyframe_id >= 3, center.x() > 50);
  }
}

TEST_F(Relocalization, IsTheSameEveryTime) {
  Relocalizer relocalizer({}, TestCamera(), &places_);
  Frame first = Seen({0.3, 0.2, 0}), second = first;
  ASSERT_TRUE(relocalizer.Relocalize(map_, {0, 0, 0}, 0, &first));
  ASSERT_TRUE(relocalizer.Relocalize(map_, {0, 0, 0}, 0, &second));
  EXPECT_EQ(first.camera_from_map.translation, second.camera_from_map.translation);
  EXPECT_EQ(first.landmark_ids, second.landmark_ids);
}

TEST_F(Relocalization, KnowsNoPlaceThatIsNotInTheMap) {
  Relocalizer relocalizer({}, TestCamera(), &places_);
  const Scene elsewhere(400, 4, 6, 16, 9);
  Frame frame = elsewhere.Observe(TestCamera(), TestScales(), CameraAt({0, 0, 0}), 77, 0.3);
  EXPECT_FALSE(relocalizer.Relocalize(map_, {0, 0, 0}, 0, &frame));
  for (const LandmarkId id : frame.landmark_ids) EXPECT_EQ(id, kNoId);
}

TEST_F(Relocalization, TrustsNoLandmarkThatMayHaveDrivenOff) {
  // All of the first room but 30 points has become a parked car since.
  int left = 30;
  for (const LandmarkId id : map_.LiveLandmarks()) {
    Landmark* landmark = map_.FindLandmark(id);
    if (map_.PositionInMap(*landmark).x() > 50 || left-- > 0) continue;
    landmark->state = MotionState::kNonMoving;
  }
  Relocalizer relocalizer({}, TestCamera(), &places_);
  Frame frame = Seen({0.2, 0.3, 0.5});
  EXPECT_FALSE(relocalizer.Relocalize(map_, {0, 0, 0}, 0, &frame));
}

TEST_F(Relocalization, WithoutAVocabularyTriesKeyframesInTurn) {
  Relocalizer relocalizer({}, TestCamera(), nullptr);
  const Eigen::Vector3d center(100.6, -0.3, 0.5);
  int attempts = 0;
  Frame frame = Seen(center);
  while (!relocalizer.Relocalize(map_, {0, 0, 0}, attempts, &frame)) ASSERT_LT(++attempts, 6);
  EXPECT_LT(Error(frame, center), 0.05);
}

}  // namespace
}  // namespace kinemap
