// SPDX-License-Identifier: Apache-2.0
#include "storage/section_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "files/crc32.h"
#include "storage/byte_reader.h"
#include "storage/byte_writer.h"

namespace kinemap {
namespace {

constexpr std::array<char, 8> kMagic{'K', 'I', 'N', 'E', 'M', 'A', 'P', '\n'};
constexpr uint32_t kVersion = 2;
constexpr size_t kHeaderBytes = kMagic.size() + 4 + 4 + 8;

class OpenFile {
 public:
  OpenFile(const std::string& path, int flags) : path_(path), number_(::open(path.c_str(), flags, 0644)) {
    if (number_ < 0) Fail();
  }
  ~OpenFile() {
    if (number_ >= 0) ::close(number_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  void Write(const std::vector<uint8_t>& bytes) {
    size_t written = 0;
    while (written < bytes.size()) {
      const ssize_t count = ::write(number_, bytes.data() + written, bytes.size() - written);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) Fail();
      written += static_cast<size_t>(count);
    }
  }
  void Sync() {
    if (::fsync(number_) != 0) Fail();
  }

 private:
  [[noreturn]] void Fail() const { throw std::system_error(errno, std::generic_category(), path_); }

  std::string path_;
  int number_;
};

}  // namespace

std::vector<uint8_t> PackSections(const Sections& sections) {
  ByteWriter body;
  for (const auto& [name, bytes] : sections) body(name, bytes);
  ByteWriter whole;
  whole.bytes().reserve(kHeaderBytes + body.bytes().size());
  whole(kMagic, kVersion, Crc32(body.bytes().data(), body.bytes().size()), static_cast<uint64_t>(body.bytes().size()));
  whole.bytes().insert(whole.bytes().end(), body.bytes().begin(), body.bytes().end());
  return std::move(whole.bytes());
}

Sections UnpackSections(const std::vector<uint8_t>& bytes) {
  if (bytes.empty()) throw MapFileError("is empty");
  if (bytes.size() < kMagic.size() || !std::equal(kMagic.begin(), kMagic.end(), bytes.begin())) {
    throw MapFileError("is not a kinemap map file");
  }
  ByteReader reader(bytes);
  std::array<char, 8> magic{};
  uint32_t version = 0, checksum = 0;
  uint64_t size = 0;
  reader(magic, version);
  if (version != kVersion) {
    throw MapFileError("is of version " + std::to_string(version) + ", expected " + std::to_string(kVersion));
  }
  reader(checksum, size);
  if (size != bytes.size() - kHeaderBytes) {
    throw MapFileError("is cut off: expected " + std::to_string(size) + " bytes after the header, got " +
                       std::to_string(bytes.size() - kHeaderBytes));
  }
  const std::span<const uint8_t> body = reader.Take(size);
  if (Crc32(body.data(), body.size()) != checksum) throw MapFileError("is damaged: its checksum does not fit");
  Sections sections;
  for (ByteReader rest(body); !rest.IsAtEnd();) {
    std::string name;
    rest(name);
    const std::span<const uint8_t> taken = rest.Take(rest.TakeCount());
    sections[name].assign(taken.begin(), taken.end());
  }
  return sections;
}

void WriteFileAtomically(const std::string& path, const std::vector<uint8_t>& bytes) {
  const std::string part = path + ".part";
  {
    OpenFile file(part, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC);
    file.Write(bytes);
    file.Sync();
  }
  if (std::rename(part.c_str(), path.c_str()) != 0) throw std::system_error(errno, std::generic_category(), path);
  const std::string folder = std::filesystem::absolute(path).parent_path().string();
  OpenFile(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC).Sync();
}

std::vector<uint8_t> ReadWholeFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<uint8_t> bytes;
  std::error_code error;
  const bool regular = std::filesystem::is_regular_file(path, error);
  if (regular && file) {
    bytes.resize(std::filesystem::file_size(path));
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (file.gcount() == static_cast<std::streamsize>(bytes.size())) return bytes;
  }
  const std::string why = regular || error ? std::strerror(error ? error.value() : errno) : "no such file";
  throw MapFileError("map file " + path + ": cannot be read: " + why);
}

}  // namespace kinemap
