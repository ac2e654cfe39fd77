#include "experiments/metrics/few_hits.h"

#include "common/core/math.h"
#include "experiments/metrics/student_t.h"

#include <fmt/format.h>

#include <cmath>

namespace gib {

namespace {

constexpr double share_to_note = 0.02;    ///< of the image's pixels
constexpr double square_of_few_hits = 6;  ///< [squared standard errors], between those of 4 and 5 hits
constexpr double sure_excess = 2;         ///< [standard errors]

bool is_lit(const Image& image, std::size_t pixel) { return (image.at(pixel) > 0).any(); }

}  // namespace

bool rests_on_few_hits(const ReferenceLayer& layer, std::size_t pixel) {
    if (!layer.standard_error) return false;
    double squares = 0, variances = 0;
    for (std::size_t i = 3 * pixel; i < 3 * pixel + 3; ++i) {
        squares += sqr(double{layer.mean.rgb[i]});
        variances += sqr(double{layer.standard_error->rgb[i]});
    }
    return squares <= square_of_few_hits * variances;
}

std::vector<std::string> notes_of_few_hits(const Reference& reference) {
    std::vector<std::string> notes;
    for (const Component c : all_components) {
        const auto& layer = reference[c];
        if (!layer) continue;
        std::size_t count = 0;
        for (std::size_t pixel = 0; pixel < layer->mean.pixels(); ++pixel)
            count += is_lit(layer->mean, pixel) && rests_on_few_hits(*layer, pixel) ? 1 : 0;
        const double share = static_cast<double>(count) / static_cast<double>(layer->mean.pixels());
        if (share >= share_to_note)
            notes.push_back(
                fmt::format("{}: {:.0f} % of the reference's pixels rest on fewer than {} hits: light may be missing "
                            "there, beyond its standard error",
                            name_of(c), 100 * share, few_hits));
    }
    return notes;
}

Image light_missed_by(const ReferenceLayer& reference, const std::vector<Image>& images) {
    Image missed(reference.mean.width, reference.mean.height);
    if (images.size() < 2 || !reference.standard_error) return missed;
    std::vector<double> values(images.size());
    for (std::size_t pixel = 0; pixel < missed.pixels(); ++pixel) {
        if (!rests_on_few_hits(reference, pixel)) continue;
        for (std::size_t i = 3 * pixel; i < 3 * pixel + 3; ++i) {
            for (std::size_t n = 0; n < images.size(); ++n)
                values[n] = double{images[n].rgb[i]};
            const SampleMean x = sample_mean(values);
            const double excess = x.value - double{reference.mean.rgb[i]};
            const double variance = x.variance.variance + sqr(double{reference.standard_error->rgb[i]});
            if (excess > sure_excess * std::sqrt(variance)) missed.rgb[i] = static_cast<float>(excess);
        }
    }
    return missed;
}

}  // namespace gib
