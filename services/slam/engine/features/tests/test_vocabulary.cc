// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <random>

#include "features/k_majority.h"
#include "features/vocabulary.h"
#include "features/vocabulary_trainer.h"

namespace kinemap {
namespace {

/// Images of `per_image` things each out of `things`; every sight of a thing has a few bits flipped.
class DescriptorImages {
 public:
  DescriptorImages(int things, uint32_t seed) : random_(seed) {
    for (int i = 0; i < things; ++i) things_.push_back({random_(), random_(), random_(), random_()});
  }

  std::vector<Descriptor> Image(int first, int count, int flipped_bits) {
    std::vector<Descriptor> seen;
    for (int i = first; i < first + count; ++i) {
      Descriptor descriptor = things_[static_cast<size_t>(i) % things_.size()];
      for (int flip = 0; flip < flipped_bits; ++flip) {
        const uint64_t bit = random_() % 256;
        descriptor[bit / 64] ^= uint64_t{1} << (bit % 64);
      }
      seen.push_back(descriptor);
    }
    return seen;
  }

 private:
  std::mt19937_64 random_;
  std::vector<Descriptor> things_;
};

Vocabulary Trained(uint64_t seed = 0) {
  DescriptorImages images(400, 1);
  std::vector<Descriptor> descriptors;
  std::vector<int> image_of_descriptor;
  for (int image = 0; image < 40; ++image) {
    for (const Descriptor& descriptor : images.Image(image * 10, 60, 12)) {
      descriptors.push_back(descriptor);
      image_of_descriptor.push_back(image);
    }
  }
  VocabularyTrainerOptions options;
  options.branching = 8;
  options.depth = 3;
  options.least_of_node = 2;
  options.seed = seed;
  return VocabularyTrainer(options).Train(descriptors, image_of_descriptor);
}

BagOfWords BagOf(const Vocabulary& vocabulary, const std::vector<Descriptor>& descriptors) {
  return vocabulary.Describe(descriptors, std::vector<uint8_t>(descriptors.size(), 1));
}

std::string Bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void Write(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

class VocabularyFile : public ::testing::Test {
 protected:
  VocabularyFile() : path_(::testing::TempDir() + "kinemap_vocabulary_" + std::to_string(getpid())) {}
  ~VocabularyFile() override { std::remove(path_.c_str()); }

  std::string Refusal() const {
    try {
      Vocabulary::Load(path_);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  }

  std::string path_;
};

TEST(KMajority, FindsClustersThatAreThere) {
  DescriptorImages images(5, 3);
  std::vector<Descriptor> descriptors = images.Image(0, 100, 10);
  std::vector<int> indices(descriptors.size());
  for (size_t i = 0; i < indices.size(); ++i) indices[i] = static_cast<int>(i);
  RandomEngine random(0, 0);
  const DescriptorClusters clusters = ClusterByMajority(descriptors, indices, 5, 20, &random);
  ASSERT_EQ(clusters.centers.size(), 5u);
  for (size_t cluster = 0; cluster < 5; ++cluster) {
    EXPECT_EQ(clusters.members[cluster].size(), 20u);
    // The majority takes the flipped bits back.
    const Descriptor thing = images.Image(clusters.members[cluster][0], 1, 0)[0];
    EXPECT_LE(HammingDistance(clusters.centers[cluster], thing), 1);
  }
}

TEST(Vocabulary, AnotherViewOfThePlaceIsMoreSimilarThanAnyOtherPlace) {
  const Vocabulary vocabulary = Trained();
  EXPECT_GT(vocabulary.word_count(), 200);
  DescriptorImages images(400, 1);
  const BagOfWords place = BagOf(vocabulary, images.Image(100, 60, 10));
  EXPECT_NEAR(Similarity(place, place), 1, 1e-6);
  const double again = Similarity(place, BagOf(vocabulary, images.Image(105, 60, 10)));
  for (const int elsewhere : {0, 200, 300}) {
    EXPECT_GT(again, 3 * Similarity(place, BagOf(vocabulary, images.Image(elsewhere, 60, 10))));
  }
}

TEST(Vocabulary, KeypointsLeftOutHaveNeitherWordNorNode) {
  const Vocabulary vocabulary = Trained();
  DescriptorImages images(400, 1);
  const std::vector<Descriptor> descriptors = images.Image(0, 10, 0);
  std::vector<uint8_t> used(10, 1);
  used[3] = 0;
  const BagOfWords bag = vocabulary.Describe(descriptors, used);
  EXPECT_EQ(bag.node_of_keypoint[3], BagOfWords::kNoNode);
  EXPECT_NE(bag.node_of_keypoint[4], BagOfWords::kNoNode);
  EXPECT_EQ(bag.node_of_keypoint.size(), 10u);
  EXPECT_TRUE(vocabulary.Describe(descriptors, std::vector<uint8_t>(10, 0)).empty());
  EXPECT_EQ(Similarity(bag, BagOfWords()), 0);
}

TEST(Vocabulary, RefusesATreeThatIsNone) {
  EXPECT_THROW(Vocabulary(Vocabulary::Tree{}), std::invalid_argument);
  EXPECT_THROW(Vocabulary(Vocabulary::Tree{{0}, {Descriptor{}}, {-1}}), std::invalid_argument);
  EXPECT_THROW(Vocabulary(Vocabulary::Tree{{2, 0}, {Descriptor{}, Descriptor{}}, {1}}), std::invalid_argument);
  EXPECT_THROW(Vocabulary(Vocabulary::Tree{{0, 1}, {Descriptor{}, Descriptor{}}, {1}}), std::invalid_argument);
}

TEST(VocabularyTrainer, RefusesOptionsOutOfRange) {
  EXPECT_THROW(VocabularyTrainer({1, 4, 10, 1, 0}), std::invalid_argument);
  EXPECT_THROW(VocabularyTrainer({10, 0, 10, 1, 0}), std::invalid_argument);
  EXPECT_THROW(VocabularyTrainer({}).Train({Descriptor{}}, {0}), std::invalid_argument);
}

TEST_F(VocabularyFile, SameSeedSameBytesAndNothingIsLost) {
  Trained().Save(path_);
  const std::string once = Bytes(path_);
  Trained().Save(path_);
  EXPECT_EQ(Bytes(path_), once);
  Trained(1).Save(path_);
  EXPECT_NE(Bytes(path_), once);
  const Vocabulary trained = Trained();
  trained.Save(path_);
  const auto loaded = Vocabulary::Load(path_);
  DescriptorImages images(400, 2);
  for (const Descriptor& descriptor : images.Image(0, 100, 0)) {
    EXPECT_EQ(loaded->WordOf(descriptor), trained.WordOf(descriptor));
  }
  EXPECT_EQ(loaded->weight(7), trained.weight(7));
}

TEST_F(VocabularyFile, RefusesEveryDamageByName) {
  EXPECT_EQ(Refusal(), "vocabulary " + path_ + ": cannot be read");
  Trained().Save(path_);
  const std::string whole = Bytes(path_);
  std::string other_version = whole;
  other_version[8] = 9;
  Write(path_, other_version);
  EXPECT_EQ(Refusal(), "vocabulary " + path_ + ": expected version 1, got 9");
  std::mt19937 random(5);
  for (int trial = 0; trial < 3000; ++trial) {
    std::string damaged = whole;
    if (trial % 3 == 0) {
      damaged.resize(random() % whole.size());
    } else {
      for (int flip = 0; flip <= trial % 4; ++flip) damaged[random() % whole.size()] ^= char(1 + random() % 255);
      if (damaged == whole) continue;
    }
    Write(path_, damaged);
    EXPECT_EQ(Refusal().rfind("vocabulary " + path_ + ": ", 0), 0u) << "trial " << trial;
  }
}

TEST_F(VocabularyFile, SaysWhereItCannotWrite) { EXPECT_THROW(Trained().Save("/nowhere/at/all"), std::runtime_error); }

}  // namespace
}  // namespace kinemap
