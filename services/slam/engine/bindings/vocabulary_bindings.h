// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

namespace kinemap {

/// Vocabulary, its trainer, and the descriptors of an image, for the tool that trains and the benchmark that measures.
void BindVocabulary(pybind11::module_& module);

}  // namespace kinemap
