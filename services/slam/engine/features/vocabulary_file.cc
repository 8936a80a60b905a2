// SPDX-License-Identifier: Apache-2.0
// A vocabulary's file, little-endian: magic, version, number of nodes, number of words; then each node's number of
// children, each node's centre but the root's, each word's weight; then the CRC-32 of all before.
#include <array>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "features/vocabulary.h"
#include "files/crc32.h"

namespace kinemap {
namespace {

constexpr std::array<char, 8> kMagic = {'k', 'm', 'v', 'o', 'c', 'a', 'b', '\n'};
constexpr uint32_t kVersion = 1;
constexpr size_t kHeaderBytes = kMagic.size() + 3 * sizeof(uint32_t);
constexpr size_t kChecksumBytes = sizeof(uint32_t);

void Append(const void* data, size_t count, std::string* bytes) {
  bytes->append(static_cast<const char*>(data), count);
}

void Append(uint32_t value, std::string* bytes) { Append(&value, sizeof(value), bytes); }

uint32_t ReadUint32(const std::string& bytes, size_t offset) {
  uint32_t value;
  std::memcpy(&value, bytes.data() + offset, sizeof(value));
  return value;
}

std::shared_ptr<const Vocabulary> Parse(const std::string& bytes) {
  if (bytes.size() < kHeaderBytes || std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) != 0) {
    throw std::invalid_argument("expected a vocabulary of kinemap, got another file of " +
                                std::to_string(bytes.size()) + " bytes");
  }
  const uint32_t version = ReadUint32(bytes, kMagic.size());
  if (version != kVersion) {
    throw std::invalid_argument("expected version " + std::to_string(kVersion) + ", got " + std::to_string(version));
  }
  const uint64_t nodes = ReadUint32(bytes, kMagic.size() + 4), words = ReadUint32(bytes, kMagic.size() + 8);
  // Checked in 64 bits before anything is allocated: the numbers may be damaged.
  const uint64_t expected =
      kHeaderBytes + nodes + (nodes == 0 ? 0 : nodes - 1) * sizeof(Descriptor) + words * sizeof(float) + kChecksumBytes;
  if (bytes.size() != expected) {
    throw std::invalid_argument("cut off or damaged: expected " + std::to_string(expected) + " bytes, got " +
                                std::to_string(bytes.size()));
  }
  const size_t checked = bytes.size() - kChecksumBytes;
  if (Crc32(bytes.data(), checked) != ReadUint32(bytes, checked)) {
    throw std::invalid_argument("damaged: its checksum does not fit");
  }
  Vocabulary::Tree tree;
  tree.child_counts.resize(nodes);
  tree.centers.resize(nodes);
  tree.word_weights.resize(words);
  const char* next = bytes.data() + kHeaderBytes;
  const auto read = [&](void* target, size_t count) {
    std::memcpy(target, next, count);
    next += count;
  };
  read(tree.child_counts.data(), nodes);
  if (nodes > 1) read(tree.centers.data() + 1, (nodes - 1) * sizeof(Descriptor));
  if (words > 0) read(tree.word_weights.data(), words * sizeof(float));
  return std::make_shared<const Vocabulary>(std::move(tree));
}

}  // namespace

std::shared_ptr<const Vocabulary> Vocabulary::Load(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::invalid_argument("vocabulary " + path + ": cannot be read");
  const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  try {
    return Parse(bytes);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("vocabulary " + path + ": " + error.what());
  }
}

void Vocabulary::Save(const std::string& path) const {
  std::string bytes(kMagic.begin(), kMagic.end());
  Append(kVersion, &bytes);
  Append(static_cast<uint32_t>(node_count()), &bytes);
  Append(static_cast<uint32_t>(word_count()), &bytes);
  Append(tree_.child_counts.data(), tree_.child_counts.size(), &bytes);
  Append(tree_.centers.data() + 1, (tree_.centers.size() - 1) * sizeof(Descriptor), &bytes);
  Append(tree_.word_weights.data(), tree_.word_weights.size() * sizeof(float), &bytes);
  Append(Crc32(bytes.data(), bytes.size()), &bytes);
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw std::runtime_error("vocabulary " + path + ": cannot be written");
}

}  // namespace kinemap
