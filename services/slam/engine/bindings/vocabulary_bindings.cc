// SPDX-License-Identifier: Apache-2.0
#include "bindings/vocabulary_bindings.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cstring>
#include <stdexcept>

#include "bindings/array_conversion.h"
#include "engine_options.h"
#include "features/orb_extractor.h"
#include "features/vocabulary_trainer.h"

namespace py = pybind11;

namespace kinemap {
namespace {

using DescriptorArray = py::array_t<uint8_t, py::array::c_style>;

std::vector<Descriptor> Descriptors(const DescriptorArray& array) {
  if (array.ndim() != 2 || array.shape(1) != static_cast<py::ssize_t>(sizeof(Descriptor))) {
    throw std::invalid_argument(Mismatch("descriptors", "a uint8 array of shape (n, 32)", array));
  }
  std::vector<Descriptor> descriptors(array.shape(0));
  std::memcpy(descriptors.data(), array.data(), descriptors.size() * sizeof(Descriptor));
  return descriptors;
}

/// (n, 32) descriptors of an image as the engine would take them, and the (n, 2) pixels they are at.
py::tuple DescriptorsOf(const py::array& image, const EngineOptions& options) {
  const cv::Mat view = ImageView<uint8_t>("image", image, CV_8U);
  const CameraModel camera(view.cols, view.rows, view.cols, view.cols, 0.5 * view.cols, 0.5 * view.rows);
  OrbExtractor extractor({options.features, {options.fast_threshold, options.fast_threshold_low}, options.threads},
                         PyramidScales(options.pyramid_levels, options.pyramid_factor));
  FrameFeaturesPtr features;
  {
    const py::gil_scoped_release release;
    features = extractor.Extract(view, camera);
  }
  DescriptorArray descriptors({features->size(), static_cast<int>(sizeof(Descriptor))});
  std::memcpy(descriptors.mutable_data(), features->descriptors.data(), features->size() * sizeof(Descriptor));
  py::array_t<double> pixels({features->size(), 2});
  for (int i = 0; i < features->size(); ++i) {
    pixels.mutable_at(i, 0) = features->keypoints[i].raw_px.x();
    pixels.mutable_at(i, 1) = features->keypoints[i].raw_px.y();
  }
  return py::make_tuple(descriptors, pixels);
}

}  // namespace

void BindVocabulary(py::module_& module) {
  py::class_<BagOfWords>(module, "BagOfWords")
      .def_readonly("words", &BagOfWords::words)
      .def_readonly("node_of_keypoint", &BagOfWords::node_of_keypoint)
      .def("similarity", [](const BagOfWords& a, const BagOfWords& b) { return Similarity(a, b); }, py::arg("other"));
  py::class_<Vocabulary, std::shared_ptr<Vocabulary>>(module, "Vocabulary")
      .def_static(
          "load", [](const std::string& path) { return std::const_pointer_cast<Vocabulary>(Vocabulary::Load(path)); },
          py::arg("path"))
      .def_static(
          "train",
          [](const DescriptorArray& descriptors, const std::vector<int>& image_of_descriptor, int branching, int depth,
             uint64_t seed) {
            const std::vector<Descriptor> rows = Descriptors(descriptors);
            VocabularyTrainerOptions options;
            options.branching = branching;
            options.depth = depth;
            options.seed = seed;
            const py::gil_scoped_release release;
            return std::make_shared<Vocabulary>(VocabularyTrainer(options).Train(rows, image_of_descriptor));
          },
          py::arg("descriptors"), py::arg("image_of_descriptor"), py::arg("branching"), py::arg("depth"),
          py::arg("seed"))
      .def("save", &Vocabulary::Save, py::arg("path"))
      .def_property_readonly("word_count", &Vocabulary::word_count)
      .def(
          "describe",
          [](const Vocabulary& vocabulary, const DescriptorArray& descriptors) {
            const std::vector<Descriptor> rows = Descriptors(descriptors);
            return vocabulary.Describe(rows, std::vector<uint8_t>(rows.size(), 1));
          },
          py::arg("descriptors"));
  module.def("descriptors_of", &DescriptorsOf, py::arg("image"), py::arg("options"));
}

}  // namespace kinemap
