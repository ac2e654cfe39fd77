#pragma once
// The numbers of the tables and the report as plain data: one row for each scene, method and component, and the cells
// and references that they come from.

#include "experiments/metrics/equal_footing.h"
#include "experiments/metrics/price_law.h"
#include "experiments/metrics/robust_error.h"
#include "experiments/metrics/spectrum.h"
#include "experiments/results/result_folder.h"

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gib {

/// The relative RMSEs for which the tables give the time: in [%] as part of column names, and as fractions.
inline constexpr std::array<const char*, 5> target_names = {"10", "5", "2", "1", "0.5"};
inline constexpr std::array<double, 5> target_errors = {0.10, 0.05, 0.02, 0.01, 0.005};
/// Whether target_errors[target] is above the noise floor [squared relative error], so that the reference can tell that
/// an image has reached it.
bool is_target_resolved(std::size_t target, double noise_floor);

struct TableRow {
    std::string scene, method, component;
    int seeds = 0;
    double seconds = 0;                             ///< mean charged seconds of the final images
    double prepare_seconds = 0;                     ///< mean seconds of preparation
    std::optional<ReplicateStatistics> statistics;  ///< empty: the component is not judged
    std::optional<RobustError> robust;
    std::optional<NoiseSpectrum> noise;
    std::vector<SpectrumPoint> bias;
    std::array<std::optional<Estimate>, target_errors.size()> times;  ///< times to each of target_errors [s]
    std::optional<Footing> footing;                                   ///< mean energy against the reference's
    std::optional<PriceLaw> law;                                      ///< law of the error against time
    std::optional<Estimate> last_halving;  ///< factor of time for the last halving of the error, as measured
    std::uint64_t nonfinite = 0;           ///< samples that were not finite, of all seeds
    double peak_rss_mib = 0;               ///< the largest of all seeds
    std::string effects_missing;           ///< names of effects that the method leaves out, separated by `;`
    double noise_floor = 0;      ///< noise floor of the reference [relative squared error]: Analysis::noise_floor()
    std::optional<double> flip;  ///< HDR-FLIP of the final images, mean over pixels and seeds; of `total` alone
    double epsilon = 0;          ///< epsilon of the relative errors [radiance^2]
    /// Names of components that hold light and of which the method leaves out paths, separated by `;`.
    std::string components_missing = {};
    bool is_unbiased = false;  ///< bias^2 is 0 by theory (known_bias.h)
    bool is_external = false;  ///< rendered by the command of another renderer
    bool floor_known = true;   ///< false: the reference has no standard error, and noise_floor is 0
    std::string cpu = {};      ///< processors_of() all seeds
};

/// A method's stored image of a scene at a charged time that is the same for all methods (equal_time_look.h).
struct EqualTimeLook {
    std::string scene, method;
    double seconds = 0;                 ///< that time; that of the first image if the method has none by then
    std::optional<double> error2 = {};  ///< mean relative squared error of the seeds then, of `total`
    std::uint32_t passes = 0;           ///< passes of seed 1's last stored image by then, or at most a tenth later
    double image_seconds = 0;           ///< charged time of that image [s]
    bool is_final = false;              ///< whether that is the final image
    std::optional<double> flip = {};    ///< HDR-FLIP of that image, mean over the pixels
};

/// The accuracy of a scene's reference, and how it was made.
struct ReferenceQuality {
    std::string scene, method;
    double relative_error = 0;  ///< standard error of the judged total, relative
    bool error_known = true;    ///< false: the reference is an image without a standard error
    std::optional<double> target;
    std::uint64_t samples = 0;  ///< samples a pixel; 0: unknown
    std::vector<std::string> notes;
    /// noise_floor_of() [relative squared error] by component, `total` included.
    std::map<std::string, double> noise_floors = {};
    double epsilon = 0;  ///< epsilon of all relative errors of the scene [radiance^2]
    /// Names of components that the reference does not resolve and that hold light, separated by `;`. If there is one,
    /// no method is the best, because a part of its image is not judged.
    std::string unjudged = {};
};

struct Analysis {
    ResultIndex index;
    std::vector<Cell> cells;     ///< complete ones, in the order of scenes, methods, seeds
    std::vector<TableRow> rows;  ///< in the order of scenes, methods, then `total` and the components
    std::vector<ReferenceQuality> references;
    /// The looks of the labels that one_label_a_method() keeps, in the order of scenes, methods.
    std::vector<EqualTimeLook> looks;
    /// The passes after which the labels that differ from (scene, label) in `spp` alone stopped; one_label_a_method()
    /// alone fills it.
    std::map<std::pair<std::string, std::string>, std::vector<std::uint32_t>> stops;
    std::vector<std::string> damage;  ///< messages: what is damaged, and the cell or scene that is left out
    std::size_t missing_cells = 0;    ///< cells of the experiment that are not complete

    /// The noise floor of a scene's reference, the relative
    /// squared error that is lost in its own noise; 0 if unknown.
    double noise_floor(const std::string& scene, const std::string& component) const;
    /// ReferenceQuality::unjudged of a scene; empty if the whole image is judged.
    std::string unjudged(const std::string& scene) const;
};

}  // namespace gib
