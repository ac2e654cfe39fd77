#include "experiments/metrics/spectrum.h"

#include "common/core/parallel.h"

#include <fftw3.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

namespace gib {

namespace {

using Field = std::vector<double>;  // one value a pixel, row 0 on top

/// The Gaussian over which the variance is pooled has this standard deviation [pixels], or more for smooth noise, over
/// which it would follow the noise itself: over 8 pixels, noise of 3 pixels has a centroid that is 2.6 % too high. A
/// centroid of f takes smooth_pooling / f, but at most the share largest_pooling of the image.
constexpr double pooling_sigma = 8, smooth_pooling = 0.6, largest_pooling = 0.25;
constexpr double edge_contrast = 0.25;  // [-] pixels with a larger relative change of brightness are masked
constexpr double low_frequency = 0.1;   // [cycles per pixel]

struct Size {
    std::size_t width, height;
    std::size_t pixels() const { return width * height; }
};

Size size_of(const Image& image) {
    return {static_cast<std::size_t>(image.width), static_cast<std::size_t>(image.height)};
}

Field channel_mean(const Image& image) {
    Field mean(image.pixels());
    for (std::size_t p = 0; p < mean.size(); ++p)
        mean[p] = (double{image.rgb[3 * p]} + double{image.rgb[3 * p + 1]} + double{image.rgb[3 * p + 2]}) / 3;
    return mean;
}

/// The half of the spectrum of a real field that FFTW computes: height x (width / 2 + 1) values.
using Spectrum = std::vector<std::complex<double>>;

std::size_t spectrum_points(Size size) { return size.height * (size.width / 2 + 1); }

fftw_complex* fftw_pointer(Spectrum& spectrum) { return reinterpret_cast<fftw_complex*>(spectrum.data()); }

void run_plan(fftw_plan plan) {
    fftw_execute(plan);
    fftw_destroy_plan(plan);
}

Spectrum transformed(Field field, Size size) {
    Spectrum spectrum(spectrum_points(size));
    const fftw_plan plan = fftw_plan_dft_r2c_2d(static_cast<int>(size.height), static_cast<int>(size.width),
                                                field.data(), fftw_pointer(spectrum), FFTW_ESTIMATE);
    run_plan(plan);
    return spectrum;
}

/// The inverse transform, so that inverse(transformed(f)) = f.
Field inverse(Spectrum spectrum, Size size) {
    Field field(size.pixels());
    const fftw_plan plan = fftw_plan_dft_c2r_2d(static_cast<int>(size.height), static_cast<int>(size.width),
                                                fftw_pointer(spectrum), field.data(), FFTW_ESTIMATE);
    run_plan(plan);
    for (double& v : field)
        v /= static_cast<double>(size.pixels());
    return field;
}

/// The periodic Hann window, 1/2 - 1/2 cos(2 pi (x + 1/2) / n). It is shifted by half a pixel so that both sides of
/// an image have equal weights.
std::vector<double> hann(std::size_t n) {
    std::vector<double> window(n);
    for (std::size_t i = 0; i < n; ++i)
        window[i] =
            0.5 - 0.5 * std::cos(2 * std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(n));
    return window;
}

Field hann_window(Size size) {
    const std::vector<double> across = hann(size.width), down = hann(size.height);
    Field window(size.pixels());
    for (std::size_t p = 0; p < window.size(); ++p)
        window[p] = across[p % size.width] * down[p / size.width];
    return window;
}

/// The correlation of the Hann window w with itself, sum_x w(x) w(x + lag) / sum_x w(x)^2, for the lags 0 to n - 1.
std::vector<double> hann_correlation(std::size_t n) {
    const std::vector<double> window = hann(n);
    std::vector<double> correlation(n);
    for (std::size_t lag = 0; lag < n; ++lag)
        for (std::size_t i = 0; i + lag < n; ++i)
            correlation[lag] += window[i] * window[i + lag];
    const double norm = correlation[0];
    for (double& v : correlation)
        v /= norm;
    return correlation;
}

/// A lag window that is 1 for lags up to a quarter of n, and falls to 0 at three quarters. The correlation of the Hann
/// window bends at lag 0, which adds 1 / (3 n^2) to the mean square of each frequency: the centroid of Gaussian noise
/// of 3 pixels is 19 % too high in 24 pixels, and 3 % in 64. A flat top adds nothing to noise whose correlation ends
/// there.
std::vector<double> flat_top(std::size_t n) {
    std::vector<double> window(n);
    for (std::size_t lag = 0; lag < n; ++lag) {
        const double u = std::clamp(2 * static_cast<double>(lag) / static_cast<double>(n) - 0.5, 0.0, 1.0);
        window[lag] = 0.5 + 0.5 * std::cos(std::numbers::pi * u);
    }
    return window;
}

/// The autocorrelation sum_p f(p) f(p + lag), summed over fields, for all lags of an image. The result has 2 width x
/// 2 height values, in which negative lags are wrapped around.
Field autocorrelation(const std::vector<Field>& fields, Size size) {
    const Size padded{2 * size.width, 2 * size.height};  // so that no lag wraps onto another
    Spectrum power(spectrum_points(padded));
    for (const Field& field : fields) {
        Field with_border(padded.pixels());
        for (std::size_t p = 0; p < field.size(); ++p)
            with_border[p / size.width * padded.width + p % size.width] = field[p];
        const Spectrum spectrum = transformed(std::move(with_border), padded);
        for (std::size_t i = 0; i < power.size(); ++i)
            power[i] += std::norm(spectrum[i]);
    }
    return inverse(std::move(power), padded);
}

/// Blurs the rows of a field, which counts as zero outside of the image, with a Gaussian, and transposes
/// the result.
Field blurred_transposed(const Field& field, Size size, double sigma) {
    const auto reach = static_cast<std::ptrdiff_t>(4 * sigma);
    std::vector<double> kernel;
    for (std::ptrdiff_t d = -reach; d <= reach; ++d)
        kernel.push_back(std::exp(-0.5 * sqr(static_cast<double>(d) / sigma)));
    Field result(field.size());
    const auto width = static_cast<std::ptrdiff_t>(size.width);
    parallel_blocks(size.height, 16, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t y = begin; y < end; ++y)
            for (std::ptrdiff_t x = 0; x < width; ++x) {
                double sum = 0;
                for (std::ptrdiff_t d = std::max(-reach, -x); d <= std::min(reach, width - 1 - x); ++d)
                    sum += kernel[static_cast<std::size_t>(d + reach)] *
                           field[y * size.width + static_cast<std::size_t>(x + d)];
                result[static_cast<std::size_t>(x) * size.height + y] = sum;
            }
    });
    return result;
}

Field blurred(const Field& field, Size size, double sigma) {
    return blurred_transposed(blurred_transposed(field, size, sigma), {size.height, size.width}, sigma);
}

/// A mask that is 0 where the brightness changes by more than the share `edge_contrast` from one side of a pixel to
/// the other, and 1 elsewhere. Sobel's operator averages three pixels along the edge, so that the reference's own
/// noise is not taken for an edge.
Field away_from_edges(const Image& reference) {
    const Size size = size_of(reference);
    Field brightness(size.pixels()), mask(size.pixels());
    for (std::size_t p = 0; p < size.pixels(); ++p)
        brightness[p] = static_cast<double>(luminance(reference.at(p)));
    const auto at = [&](std::size_t x, std::size_t y, int dx, int dy) {
        const std::ptrdiff_t px = static_cast<std::ptrdiff_t>(x) + dx, py = static_cast<std::ptrdiff_t>(y) + dy;
        const auto cx = std::clamp<std::ptrdiff_t>(px, 0, static_cast<std::ptrdiff_t>(size.width) - 1);
        const auto cy = std::clamp<std::ptrdiff_t>(py, 0, static_cast<std::ptrdiff_t>(size.height) - 1);
        return brightness[static_cast<std::size_t>(cy) * size.width + static_cast<std::size_t>(cx)];
    };
    for (std::size_t y = 0; y < size.height; ++y)
        for (std::size_t x = 0; x < size.width; ++x) {
            double across = 0, down = 0, mean = 0;
            for (int t = -1; t <= 1; ++t) {
                const double weight = t == 0 ? 0.5 : 0.25;
                across += weight * (at(x, y, 1, t) - at(x, y, -1, t));
                down += weight * (at(x, y, t, 1) - at(x, y, t, -1));
                for (int s = -1; s <= 1; ++s)
                    mean += at(x, y, s, t) / 9;
            }
            mask[y * size.width + x] = std::hypot(across, down) > edge_contrast * std::abs(mean) ? 0 : 1;
        }
    return mask;
}

/// The noise of the replicates, scaled to variance 1 in every pixel that the mask keeps; it is 0 elsewhere.
struct WhitenedNoise {
    std::vector<Field> replicates;
    Field mask;
};

/// The channels are averaged first, so that every pixel has variance 1 however its channels are correlated.
WhitenedNoise whitened_noise(const std::vector<Image>& images, const Image& reference, double sigma) {
    const Size size = size_of(reference);
    const auto n = static_cast<double>(images.size());
    WhitenedNoise noise{{}, away_from_edges(reference)};
    for (const Image& image : images)
        noise.replicates.push_back(channel_mean(image));
    Field variance(size.pixels());
    for (std::size_t p = 0; p < size.pixels(); ++p) {
        double mean = 0;
        for (const Field& x : noise.replicates)
            mean += x[p] / n;
        for (Field& x : noise.replicates) {
            // The factor makes the variance unbiased: deviations from the mean of n values have only (n - 1) / n of
            // the variance.
            x[p] = (x[p] - mean) * std::sqrt(n / (n - 1));
            variance[p] += sqr(x[p]) / n;
        }
        // So small a variance comes from rounding to the floats of the files, not from noise.
        if (!(variance[p] > sqr(mean * 0x1p-22))) noise.mask[p] = 0;
        variance[p] *= noise.mask[p];
    }
    // Division by the blurred mask normalises: a pixel beside a masked area pools fewer pixels instead of zeros.
    const Field pooled = blurred(variance, size, sigma), weight = blurred(noise.mask, size, sigma);
    for (Field& x : noise.replicates)
        for (std::size_t p = 0; p < size.pixels(); ++p)
            x[p] = noise.mask[p] > 0 ? x[p] / std::sqrt(pooled[p] / weight[p]) : 0;
    return noise;
}

/// Calls visit(frequency [cycles per pixel], index, multiplicity) for each stored point of a half spectrum. The
/// multiplicity is 2 where the mirrored point is not stored.
template <class Visit>
void for_each_frequency(Size size, const Visit& visit) {
    const std::size_t columns = size.width / 2 + 1;
    for (std::size_t y = 0; y < size.height; ++y)
        for (std::size_t x = 0; x < columns; ++x) {
            const double fx = static_cast<double>(x) / static_cast<double>(size.width);
            const double fy = static_cast<double>(std::min(y, size.height - y)) / static_cast<double>(size.height);
            const bool own_mirror = x == 0 || 2 * x == size.width;
            visit(std::hypot(fx, fy), y * columns + x, own_mirror ? 1.0 : 2.0);
        }
}

/// The means over rings that are one frequency step wide; DC is a ring of its own.
std::vector<SpectrumPoint> radial(const Field& power, Size size) {
    const auto steps = static_cast<double>(std::min(size.width, size.height));
    std::vector<SpectrumPoint> rings(static_cast<std::size_t>(std::sqrt(0.5) * steps) + 2, SpectrumPoint{0, 0});
    std::vector<double> counts(rings.size(), 0);
    for_each_frequency(size, [&](double frequency, std::size_t i, double multiplicity) {
        auto ring = static_cast<std::size_t>(std::lround(frequency * steps));
        if (ring == 0 && frequency > 0) ring = 1;  // occurs only if the image is not square
        rings[ring].frequency += multiplicity * frequency;
        rings[ring].power += multiplicity * power[i];
        counts[ring] += multiplicity;
    });
    std::vector<SpectrumPoint> curve;
    for (std::size_t r = 0; r < rings.size(); ++r)
        if (counts[r] > 0) curve.push_back({rings[r].frequency / counts[r], rings[r].power / counts[r]});
    return curve;
}

/// The bias, mean of replicates - mean of groups, from one half of each and averaged over the channels.
Field half_bias(const std::vector<Image>& replicates, const std::vector<Image>& groups, bool second) {
    const auto part = [second](std::span<const Image> images) {
        const std::size_t half = images.size() / 2;
        return channel_mean(mean_image(second ? images.subspan(half) : images.first(half)));
    };
    Field bias = part(replicates);
    const Field r = part(groups);
    for (std::size_t p = 0; p < bias.size(); ++p)
        bias[p] -= r[p];
    return bias;
}

/// The autocorrelations of noise that is known only in the pixels of a mask, and of the mask.
struct Correlations {
    Field products, pairs;
};

/// The power spectrum of stationary noise that is known only in the pixels of a mask, at the frequencies of an image,
/// with a lag window for each axis. White noise has power 1.
///
/// A transform of the masked and windowed image would broaden the spectrum of smooth noise (its centroid by 15 % where
/// a disc of a fifth of the width is masked), and the window would waste most pixels. The correlation function avoids
/// both. The sum of z(p) z(p + lag) over the pairs of pixels kept, divided by the number of pairs, is unbiased for any
/// mask. Times the correlation of the Hann window with itself, its transform has the same expectation as the
/// periodogram of an unmasked image under that window, which is never negative. Moments of the spectrum take
/// flat_top(). MASTER (Hivon et al. 2002, ApJ 567) does the same for maps of the sky. The mean of an image is not
/// subtracted: the noise has mean zero by construction, and power would be lost around DC.
Field power_through_mask(const Correlations& correlations, Size size, std::vector<double> (*lag_window)(std::size_t)) {
    // A lag is damped if it has few pairs: fewer than this share
    // of its weight by the window, times the pairs of lag 0.
    constexpr double least_share = 0.1;
    const auto& [products, pairs] = correlations;
    const std::vector<double> across = lag_window(size.width), down = lag_window(size.height);
    const double variance = products[0] / pairs[0];  // summed over the replicates, like `products`
    // Lags that differ by the width or the height have the same phase at the frequencies of the image.
    Field folded(size.pixels());
    for (std::size_t y = 0; y < 2 * size.height; ++y)
        for (std::size_t x = 0; x < 2 * size.width; ++x) {
            if (x == size.width || y == size.height) continue;  // no pair has this lag
            const std::size_t lag_x = std::min(x, 2 * size.width - x), lag_y = std::min(y, 2 * size.height - y);
            const std::size_t i = y * 2 * size.width + x;
            const double weight = across[lag_x] * down[lag_y];
            const double count = std::max(pairs[i], least_share * weight * pairs[0]);
            if (count > 0)
                folded[y % size.height * size.width + x % size.width] += weight * products[i] / count / variance;
        }
    const Spectrum spectrum = transformed(std::move(folded), size);
    Field power(spectrum.size());
    for (std::size_t i = 0; i < power.size(); ++i)
        power[i] = std::real(spectrum[i]);
    return power;
}

/// noise_spectrum() with the variance pooled over a Gaussian of `sigma` pixels.
std::optional<NoiseSpectrum> pooled_spectrum(const std::vector<Image>& replicates, const Image& reference,
                                             double sigma) {
    const Size size = size_of(reference);
    const WhitenedNoise noise = whitened_noise(replicates, reference, sigma);
    if (std::ranges::none_of(noise.mask, [](double kept) { return kept > 0; })) return std::nullopt;
    const Correlations correlations{autocorrelation(noise.replicates, size), autocorrelation({noise.mask}, size)};
    const Field power = power_through_mask(correlations, size, flat_top);

    double sum = 0, moment = 0, low = 0, low_count = 0, count = 0;
    for_each_frequency(size, [&](double frequency, std::size_t i, double multiplicity) {
        if (frequency == 0) return;
        sum += multiplicity * power[i];
        moment += multiplicity * frequency * power[i];
        count += multiplicity;
        if (frequency >= low_frequency) return;
        low += multiplicity * power[i];
        low_count += multiplicity;
    });
    if (!(sum > 0)) return std::nullopt;
    const double low_ratio = low_count > 0 ? low / sum * count / low_count : std::numeric_limits<double>::quiet_NaN();
    return NoiseSpectrum{radial(power_through_mask(correlations, size, hann_correlation), size), moment / sum,
                         low_ratio};
}

}  // namespace

std::optional<NoiseSpectrum> noise_spectrum(const std::vector<Image>& replicates, const Image& reference) {
    if (replicates.size() < 3 || reference.pixels() < 2) return std::nullopt;
    const auto spectrum = pooled_spectrum(replicates, reference, pooling_sigma);
    const double largest = largest_pooling * std::min(reference.width, reference.height);
    if (!spectrum || !(spectrum->centroid * pooling_sigma < smooth_pooling) || largest <= pooling_sigma)
        return spectrum;
    const double needed = spectrum->centroid > 0 ? smooth_pooling / spectrum->centroid : largest;
    return pooled_spectrum(replicates, reference, std::min(needed, largest));
}

std::vector<SpectrumPoint> bias_spectrum(const std::vector<Image>& replicates, const ReferenceLayer& reference) {
    if (replicates.size() < 2 || reference.groups.size() < 2) return {};
    const Size size = size_of(reference.mean);
    const Field window = hann_window(size);
    const double white = std::inner_product(window.begin(), window.end(), window.begin(), 0.0);
    const auto windowed = [&](bool second_half) {
        Field bias = half_bias(replicates, reference.groups, second_half);
        for (std::size_t p = 0; p < bias.size(); ++p)
            bias[p] *= window[p];
        return transformed(std::move(bias), size);
    };
    const Spectrum first = windowed(false), second = windowed(true);
    Field power(first.size());
    // The halves share no noise, so that the expectation of the product is the power of the bias alone. An estimate
    // may be negative.
    for (std::size_t i = 0; i < power.size(); ++i)
        power[i] = std::real(first[i] * std::conj(second[i])) / white;
    return radial(power, size);
}

}  // namespace gib
