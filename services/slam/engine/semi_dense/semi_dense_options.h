// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kinemap {

/// Search of one pixel along its epipolar line in another keyframe.
struct EpipolarSearchOptions {
  float least_line_cosine = 0.2f;         ///< between the pixel's gradient and its epipolar line
  float least_gradient_cosine = 0.7071f;  ///< between the gradients of the two pixels
  float least_gradient_ratio = 0.4f;      ///< of the two gradients' moduli, either way
  float intensity_sigma = 6;              ///< grey levels, of the difference of two pixels of one point
  float place_sigma_px = 0.5f;            ///< how far a step of the search may lie beside the point
  float gradient_variance_ratio = 0.23f;  ///< variance of a difference of moduli by that of intensities
  float max_error = 4;                    ///< mean squared error in sigmas
  float max_ambiguity = 0.7f;             ///< best error over the best one elsewhere on the line
  float line_sigma_px = 0.3f;             ///< how far the epipolar line may lie beside the point
};

/// From estimates of single keyframe pairs to one image of inverse depths.
struct SemiDenseOptions {
  EpipolarSearchOptions search;
  float least_gradient = 8;          ///< grey levels a pixel
  int most_pixels = 40000;           ///< searched in a keyframe, those with the strongest gradients
  int neighbors = 7;                 ///< keyframes searched
  int later_keyframes = 3;           ///< that have to come before one is estimated, and as many more to check it
  int window_keyframes = 11;         ///< whose images are kept
  int delay_frames = 10;             ///< work that begins at frame k is taken at frame k + this
  int most_under_way = 3;            ///< keyframes beyond these are left out
  int least_hypotheses = 3;          ///< that agree on a pixel
  int least_consistent = 2;          ///< other keyframes whose inverse depths agree
  float max_relative_sigma = 0.05f;  ///< of a point that is given out
};

}  // namespace kinemap
