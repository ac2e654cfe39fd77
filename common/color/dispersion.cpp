#include "common/color/dispersion.h"

#include "common/color/cie.h"

#include <array>

namespace gib {

namespace {

constexpr double shortest = 400, longest = 700;  ///< [nm]

double per_square_um(double wavelength) { return sqr(1000 / wavelength); }

std::array<Color, wavelength_strata> stratum_weights() {
    // Number of samples for the integral over a stratum; the tables are linear between multiples of 5 nm.
    constexpr int parts = 64;
    constexpr double width = (longest - shortest) / wavelength_strata;
    std::array<Colord, wavelength_strata> shown;
    Colord sum = Colord::Zero();
    for (int k = 0; k < wavelength_strata; ++k) {
        Colord xyz = Colord::Zero();
        for (int i = 0; i < parts; ++i) {
            const double wavelength = shortest + width * (k + (i + 0.5) / parts);
            xyz += cie_d65(wavelength) * cie_1931_xyz(wavelength);
        }
        auto& rgb = shown[static_cast<std::size_t>(k)] = rgb_of_xyz(xyz).max(0.0);
        sum += rgb;
    }
    std::array<Color, wavelength_strata> weights;
    for (std::size_t k = 0; k < weights.size(); ++k)
        weights[k] = (shown[k] * wavelength_strata / sum).cast<float>();
    return weights;
}

}  // namespace

double stratum_wavelength(int stratum) { return shortest + (longest - shortest) * (stratum + 0.5) / wavelength_strata; }

const Color& stratum_weight(int stratum) {
    static const auto weights = stratum_weights();
    return weights[static_cast<std::size_t>(stratum)];
}

double cauchy_index(double index, double b, double wavelength) {
    return index + b * (per_square_um(wavelength) - per_square_um(d_line));
}

double cauchy_b_of_abbe(double index, double abbe) {
    return (index - 1) / (abbe * (per_square_um(f_line) - per_square_um(c_line)));
}

}  // namespace gib
