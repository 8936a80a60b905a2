// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <opencv2/core.hpp>
#include <vector>

#include "storage/byte_reader.h"

namespace kinemap {

/// A plain image of bytes or floats; also an empty one.
template <typename Archive>
void Serialize(Archive& archive, cv::Mat& image) {
  constexpr int32_t kMostPixels = 1 << 15;  // a side
  int32_t rows = image.rows, columns = image.cols, type = image.type();
  std::vector<uint8_t> bytes;
  if constexpr (!Archive::kReads) {
    const cv::Mat whole = image.isContinuous() ? image : image.clone();
    bytes.assign(whole.data, whole.data + whole.total() * whole.elemSize());
  }
  archive(rows, columns, type, bytes);
  if constexpr (Archive::kReads) {
    const bool is_image =
        rows >= 0 && columns >= 0 && rows <= kMostPixels && columns <= kMostPixels && (type == CV_8U || type == CV_32F);
    const size_t expected = is_image ? static_cast<size_t>(rows) * columns * CV_ELEM_SIZE(type) : 0;
    if (!is_image || bytes.size() != expected) throw MapFileError("damaged: an image");
    image.create(rows, columns, type);
    if (!bytes.empty()) std::memcpy(image.data, bytes.data(), bytes.size());
  }
}

}  // namespace kinemap
