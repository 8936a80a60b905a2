// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace kinemap {

/// Named pieces of a file. A reader looks for those it knows and passes over the others, so that a later version can
/// add some.
using Sections = std::map<std::string, std::vector<uint8_t>>;

/// magic, version, CRC-32 and length of what follows, then each section: name, length, bytes. Little-endian.
std::vector<uint8_t> PackSections(const Sections& sections);

/// Throws MapFileError for bytes that are empty, cut off, changed, of another version or no map at all.
Sections UnpackSections(const std::vector<uint8_t>& bytes);

/// Writes a file whole or not at all: beside it first, synced, then renamed. Throws std::system_error that names it.
void WriteFileAtomically(const std::string& path, const std::vector<uint8_t>& bytes);

/// Throws MapFileError that names the file when it cannot be read.
std::vector<uint8_t> ReadWholeFile(const std::string& path);

}  // namespace kinemap
