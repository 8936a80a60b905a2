// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <random>
#include <string>

#include "storage/map_saver.h"
#include "synthetic/scene.h"

namespace kinemap {
namespace {

using synthetic::CameraAt;
using synthetic::MapOf;
using synthetic::Scene;
using synthetic::TestCamera;
using synthetic::TestScales;

std::vector<RigidTransform> Row(int count) {
  std::vector<RigidTransform> cameras;
  for (int k = 0; k < count; ++k) cameras.push_back(CameraAt({0.3 * k, 0, 0}));
  return cameras;
}

/// Two maps, one of them with everything a map can have.
void Fill(Atlas* atlas) {
  const Scene scene(40, 3, 6, 14);
  auto rich = std::make_unique<SlamMap>(MapOf(scene, TestCamera(), Row(5)));
  const std::vector<LandmarkId> landmarks = rich->LiveLandmarks();
  rich->RemoveLandmark(landmarks[3]);
  rich->FuseLandmarks(landmarks[5], landmarks[6]);
  rich->AddLoopEdge(0, 4);
  rich->CullKeyframe(2);
  rich->FindLandmark(landmarks[7])->object_id = 12;
  rich->FindLandmark(landmarks[7])->state = MotionState::kNonMoving;
  rich->SetKeyframePose(3, SimilarityTransform(rich->MapFromKeyframe(3), 1.25));
  rich->TakeChanges();
  rich->FindLandmark(landmarks[8])->valid_until_ns = 77;
  rich->MarkChanged(*rich->FindLandmark(landmarks[8]));
  atlas->Add(std::move(rich));
  auto second = std::make_unique<SlamMap>(atlas->next_map_id(), TestScales());
  second->InsertKeyframe(scene.Observe(TestCamera(), TestScales(), CameraAt({0, 0, 0}), 900));
  atlas->Add(std::move(second));
  atlas->ReserveMapIds(7);
  atlas->Activate(0);
}

std::vector<uint8_t> BytesOf(const Atlas& atlas) { return MapSnapshot(atlas, TestCamera()).Bytes(); }

class MapFile : public ::testing::Test {
 protected:
  void SetUp() override {
    Fill(&atlas_);
    bytes_ = BytesOf(atlas_);
  }

  std::string WhyRefused(const std::vector<uint8_t>& bytes, const CameraModel& camera = TestCamera()) {
    Atlas atlas(0, TestScales());
    try {
      ReadMaps(bytes, camera, &atlas);
    } catch (const MapFileError& error) {
      return error.what();
    }
    return "";
  }

  Atlas atlas_{0, TestScales()};
  std::vector<uint8_t> bytes_;
};

TEST_F(MapFile, ComesBackToTheLastBit) {
  Atlas read(0, TestScales());
  ReadMaps(bytes_, TestCamera(), &read);
  EXPECT_EQ(BytesOf(read), bytes_);
  ASSERT_EQ(read.maps().size(), 2u);
  EXPECT_EQ(read.active_map_id(), 0);
  EXPECT_EQ(read.next_map_id(), 7);
  const SlamMap& map = *read.Find(0);
  EXPECT_EQ(map.live_keyframe_count(), 4);
  EXPECT_EQ(map.landmark_count(), atlas_.Find(0)->landmark_count());
  EXPECT_EQ(map.covisibility().Edges(0), atlas_.Find(0)->covisibility().Edges(0));
  const MapChanges changes = read.Find(0)->TakeChanges(), expected = atlas_.Find(0)->TakeChanges();
  EXPECT_EQ(changes.landmarks, expected.landmarks);
  EXPECT_EQ(changes.landmarks.size(), 1u);
}

TEST_F(MapFile, OfAnotherSessionTellsOfEverythingAndRenamesItsObjects) {
  SlamMap* map = atlas_.Find(0);
  MapCodec::MarkAllChanged(map);
  MapCodec::RenameObjects({{12, 4000000000u}}, map);
  EXPECT_EQ(MapCodec::Objects(*map), std::set<uint32_t>{4000000000u});
  const MapChanges changes = map->TakeChanges();
  EXPECT_EQ(changes.keyframes.size(), 5u);
  EXPECT_EQ(changes.landmarks, map->LiveLandmarks());
}

TEST_F(MapFile, IsRefusedInOneLineWhenItIsNotWhole) {
  EXPECT_EQ(WhyRefused({}), "is empty");
  EXPECT_EQ(WhyRefused({'h', 'e', 'l', 'l', 'o', ' ', 'y', 'o', 'u'}), "is not a kinemap map file");
  std::vector<uint8_t> cut(bytes_.begin(), bytes_.end() - 100);
  EXPECT_NE(WhyRefused(cut).find("is cut off: expected"), std::string::npos);
  for (const size_t size : {9, 13, 23, 24, 25}) {
    EXPECT_NE(WhyRefused({bytes_.begin(), bytes_.begin() + size}), "") << size;
  }
  std::vector<uint8_t> flipped = bytes_;
  flipped[bytes_.size() / 2] ^= 4;
  EXPECT_EQ(WhyRefused(flipped), "is damaged: its checksum does not fit");
  std::vector<uint8_t> newer = bytes_;
  newer[8] = 9;
  EXPECT_EQ(WhyRefused(newer), "is of version 9, expected 2");
}

TEST_F(MapFile, IsRefusedForAnotherCamera) {
  const CameraModel other(640, 480, 501, 500, 320, 240);
  EXPECT_EQ(WhyRefused(bytes_, other), "was made with another camera or pyramid: fx 500, expected 501");
}

TEST_F(MapFile, IsRefusedWhenTwoMapsGoOnWithTheSameIds) {
  atlas_.Find(1)->set_id_block(0);
  EXPECT_EQ(WhyRefused(BytesOf(atlas_)), "damaged: ids of block 0 in map 1");
  atlas_.Find(1)->set_id_block(7);
  EXPECT_EQ(WhyRefused(BytesOf(atlas_)), "damaged: ids of block 7 in map 1");
}

TEST_F(MapFile, TellsTheDistortionThatItsFeaturesAreFreeOf) {
  EXPECT_EQ(RemainingRadial(UnpackSections(bytes_)), 0);
  Sections sections = UnpackSections(MapSnapshot(atlas_, TestCamera().WithRemainingRadial(0.015)).Bytes());
  EXPECT_EQ(RemainingRadial(sections), 0.015);
  Atlas read(0, TestScales());
  ReadMaps(PackSections(sections), TestCamera(), &read);
  EXPECT_EQ(read.maps().size(), 2u);
  sections["lens"].back() = 0x7f;
  EXPECT_THROW(RemainingRadial(sections), MapFileError);
  sections.erase("lens");
  EXPECT_EQ(RemainingRadial(sections), 0) << "of an earlier version";
}

/// What a reader would do with a map that it was given.
void WalkThrough(Atlas* atlas) {
  for (const auto& map : atlas->maps()) {
    map->TakeChanges();
    for (const KeyframeId id : map->LiveKeyframes()) {
      map->UpdateCovisibility(id);
      if (id != map->first_keyframe_id()) map->CullKeyframe(id);
    }
    for (const LandmarkId id : map->LiveLandmarks()) map->PositionInMap(*map->FindLandmark(id));
    map->TakeChanges();
  }
}

TEST_F(MapFile, WithAChecksumThatFitsEverythingElseIsCheckedToo) {
  std::mt19937 random(5);
  const Sections whole = UnpackSections(bytes_);
  int refused = 0;
  constexpr int kTrials = 4000;
  for (int trial = 0; trial < kTrials; ++trial) {
    Sections sections = whole;
    auto section = sections.begin();
    std::advance(section, random() % sections.size());
    std::vector<uint8_t>& bytes = section->second;
    const int changes = 1 + static_cast<int>(random() % 3);
    for (int i = 0; i < changes; ++i) bytes[random() % bytes.size()] = static_cast<uint8_t>(random());
    if (trial % 10 == 0) bytes.resize(random() % bytes.size());
    Atlas atlas(0, TestScales());
    try {
      ReadMaps(PackSections(sections), TestCamera(), &atlas);
      WalkThrough(&atlas);
    } catch (const MapFileError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, kTrials / 10);
}

TEST_F(MapFile, IsWrittenWholeOrNotAtAll) {
  const std::string path = ::testing::TempDir() + "whole.kmap";
  MapSaver saver;
  saver.Start(MapSnapshot(atlas_, TestCamera()), path);
  saver.Wait();
  EXPECT_EQ(ReadWholeFile(path), bytes_);
  EXPECT_FALSE(std::filesystem::exists(path + ".part"));
  saver.Start(MapSnapshot(atlas_, TestCamera()), "/nowhere/at/all.kmap");
  EXPECT_THROW(saver.Wait(), std::system_error);
  EXPECT_THROW(ReadWholeFile("/nowhere/at/all.kmap"), MapFileError);
}

}  // namespace
}  // namespace kinemap
