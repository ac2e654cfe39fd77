#pragma once
// Non-local means with two half buffers: takes noise out of an image of a Monte Carlo method, and pays with bias.
// Sources: [1] Rousselle, Knaus and Zwicker 2012, "Adaptive Rendering with Non-Local Means Filtering"; [2] Rousselle, Manzi and
// Zwicker 2013, "Robust Denoising using Feature and Color Information".
//
// | symbol | meaning |
// |---|---|
// | A, B; n_A, n_B | the means over two disjoint sets of passes, and their numbers of passes |
// | v_A(p) | variance of the mean A at p |
// | p, q | a pixel and another one, at most `search_radius` columns and rows away |
// | f, v_f, g_f | a channel of the features (albedo, normal, depth): mean, variance and squared slope |
//
// A consists of the means A_1 over n_1 passes and A_2 over n_2, whose noise is independent: E (A_1 - A_2)^2 = sigma^2 (1 / n_1 + 1 / n_2)
// for a variance sigma^2 of one pass. The variance of A, averaged over a square around p as one difference is all noise, is therefore
//     (1)  v_A(p) = mean of (A_1 - A_2)^2 n_1 n_2 / (n_1 + n_2)^2.
// Two pixels of the same expected value differ by v(p) + v(q) on average; [1] takes off what this explains (min: a dark
// pixel is not to accept every bright and noisy one) and measures the rest in standard deviations, with c over the channels:
//     (2)  D^2(p, q, c) = ((A(p) - A(q))^2 - v(p) - min(v(p), v(q))) / (epsilon + k^2 (v(p) + v(q)))
//     (3)  d_A^2(p, q) = mean of D^2(p + o, q + o, c) over c and the offsets o of a square patch.
// Features differ likewise ([2]), but pixel by pixel. A tolerance tau and the slope take the place of a variance near 0; the
// slope of the depth counts by the distance of q, since a plane is one surface (as in Schied et al. 2017):
//     (4)  d_f^2(p, q) = max over f of ((f(p) - f(q))^2 - v_f(p) - min(v_f(p), v_f(q))) / (k_f^2 max(tau, v_f(p), g_f(p))).
// The smaller of both weights counts ([2]):
//     (5)  w_A(p, q) = exp(-max(0, d_A^2, d_f^2)),
// where exp(-x) is (1 - x / 16)^16, and 0 beyond x = 16. The weights of one half filter the other one ([1]): a pixel's
// own noise does not choose its neighbours, which would favour those with the same noise.
//     (6)  B'(p) = sum over q of w_A(p, q) B(q) / sum over q of w_A(p, q), A' alike; the image is (n_A A' + n_B B') / (n_A + n_B).
//
// Given the weights, (6) is linear in B. The weights are those of the sum of all components and filter each component, so that
// components still add up to the image.
// Bias: the mean of pixels that differ by less than the noise; it falls as the noise does. Spikes become spots. Beyond the borders the
// image is mirrored. Noise that both halves share, such as that of a photon map, is taken for part of the scene.

#include "common/images/image.h"

#include <array>
#include <cstdint>

namespace gib {

/// Facts about the first surface that a pixel sees, as means over its samples; 0 where a ray meets none.
struct FeatureImages {
    Image albedo;  ///< share of light that is scattered, by channel
    Image normal;  ///< shading normal, turned to the camera
    Image depth;   ///< distance from the start of the camera's ray [scene units], the same in all channels
};

/// One of two disjoint sets of passes of a run.
struct HalfImage {
    ComponentImages mean;
    Image variance;  ///< estimate of the variance of the mean's total, which may have a single degree of freedom
    double passes = 0;
};

/// (x - y)^2 n_x n_y / (n_x + n_y)^2: the variance of the mean over all passes, by the means x over n_x passes and y over n_y.
Image variance_of_mean(const Image& x, double n_x, const Image& y, double n_y);

struct NonLocalMeansSettings {
    int search_radius = 7, patch_radius = 2, variance_radius = 2;  ///< of squares [pixels]
    float k = 0.45f, k_feature = 0.6f;                             ///< how far values may differ [standard deviations]
    float tolerance = 1e-3f;                                       ///< tau, for features whose largest value is 1
};

/// The filtered image of two halves with the same components. `features` are those of two disjoint sets of samples, or null: then color
/// alone decides. The result does not depend on the number of threads.
ComponentImages non_local_means(const std::array<HalfImage, 2>& halves, const std::array<FeatureImages, 2>* features,
                                const NonLocalMeansSettings& settings = {});

}  // namespace gib
