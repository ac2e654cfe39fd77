#pragma once
// The numbers of the tables and the report as plain data: one row for each scene, method and layer, and the cells and
// references that they come from.

#include "common/scene/effects.h"
#include "experiments/analysis/field.h"
#include "experiments/metrics/energy_balance.h"
#include "experiments/metrics/price_law.h"
#include "experiments/metrics/robust_error.h"
#include "experiments/metrics/spectrum.h"
#include "experiments/results/layer.h"
#include "experiments/results/result_folder.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace gib {

/// The relative RMSEs for which the tables give the time: in [%] as part of column names, and as fractions.
inline constexpr std::array<const char*, 5> target_names = {"10", "5", "2", "1", "0.5"};
inline constexpr std::array<double, 5> target_errors = {0.10, 0.05, 0.02, 0.01, 0.005};
/// Whether target_errors[target] is above the noise floor [squared relative error], and can be measured.
bool is_target_resolved(std::size_t target, double noise_floor);

struct TableRow {
    std::string scene, method;
    std::string name = {};  ///< short name of the method (method_names.h)
    Layer layer = Layer::total;
    int seeds = 0;
    double seconds = 0;                               ///< mean charged seconds of the final images
    double prepare_seconds = 0;                       ///< mean seconds of preparation
    std::uint32_t least_passes = 0, most_passes = 0;  ///< of the seeds
    std::optional<ReplicateStatistics> statistics =
        {};  ///< empty: the reference lacks the layer or is contradicted in it
    std::optional<RobustError> robust = {};
    std::optional<NoiseSpectrum> noise = {};
    std::vector<SpectrumPoint> bias = {};
    std::array<std::optional<Estimate>, target_errors.size()> times = {};  ///< times to each of target_errors [s]
    std::array<int, target_errors.size()> reached = {};  ///< number of seeds that have reached each of them
    std::optional<EnergyBalance> balance = {};           ///< mean energy against the reference's
    std::optional<PriceLaw> law = {};                    ///< law of the error against time
    std::optional<Estimate> last_halving = {};           ///< factor by which time grew while the error fell to half
    std::uint64_t nonfinite = 0;                         ///< samples that were not finite, of all seeds
    double peak_rss_mib = 0;                             ///< the largest of all seeds
    Effects effects_missing = {};                        ///< effects that the method leaves out
    /// Noise floor of the reference [relative squared error], Analysis::noise_floor(), and of light that it
    /// may have missed (unsampled_light.h).
    double noise_floor = 0;
    std::optional<double> flip = {};  ///< HDR-FLIP of the final images, mean over pixels and seeds; of the total alone
    double epsilon = 0;               ///< epsilon of the relative errors [radiance^2]
    Components components_missing = {};  ///< lit components that the method samples incompletely
    bool is_unbiased =
        false;  ///< bias^2 is 0 by theory (row_fields.h), against a reference of known error, and no energy contradicts that
    /// Layers of the method in which it declares itself unbiased, but has another mean energy than the reference
    /// (energy_test.h): that of the row itself, in the row of the total those of all rows.
    std::vector<Layer> contradicted_in = {};
    double unsampled = 0;             ///< squared relative error that is unsampled light (unsampled_light.h)
    bool has_times = true;            ///< false: its curves include components in which the reference is contradicted
    bool is_external = false;         ///< rendered by the command of another renderer
    bool floor_known = true;          ///< false: the reference has no standard error, and noise_floor is 0
    std::set<std::string> cpus = {};  ///< names of the processors that measured the seeds

    /// Whether the method has all light of the scene.
    bool is_complete() const { return effects_missing.empty() && components_missing.empty(); }
    bool has_verdict(BalanceVerdict verdict) const { return balance && balance->verdict == verdict; }
};

/// Seed 1's last stored image up to the time at which all methods are compared, or at most a tenth later; else its
/// first (comparison.h).
struct EqualTimeLook {
    std::string scene, method;
    std::uint32_t passes = 0;
    double seconds = 0;               ///< charged time of that image [s]
    bool is_final = false;            ///< whether that is the final image
    std::optional<double> flip = {};  ///< HDR-FLIP of that image, mean over the pixels
};

/// The accuracy of a scene's reference, and how it was made.
struct ReferenceQuality {
    std::string scene, method;
    double relative_error = 0;  ///< relative standard error of the total
    bool error_known = true;    ///< false: the reference is an image without a standard error
    std::optional<double> target = {};
    std::uint64_t samples = 0;  ///< samples a pixel; 0: unknown
    std::vector<std::string> notes = {};
    /// noise_floor_of() [relative squared error].
    std::map<Layer, double> noise_floors = {};
    double epsilon = 0;  ///< epsilon of all relative errors of the scene [radiance^2]
    /// Lit components that the reference lacks or in which it is contradicted. If there is one, there is no verdict.
    Components unjudged = {};
};

/// A warning that a reader has to know before any number.
struct Warning {
    enum class Kind {
        no_light,
        busy_machine,
        unlike_processors,
        equal_images,
        reference_contradicted,
        declaration_contradicted,
        energy_differs
    };
    Kind kind;
    std::string scene;         ///< empty: it is about the whole experiment
    std::string sentence;      ///< without its full stop
    std::string command = {};  ///< what helps; may be empty
};

struct Analysis {
    ResultIndex index;
    std::vector<Cell> cells;     ///< complete ones, in the order of scenes, methods, seeds
    std::vector<TableRow> rows;  ///< in the order of scenes, methods, layers
    std::vector<ReferenceQuality> references;
    std::vector<Warning> warnings;  ///< on top of table and report
    /// The looks of the labels that one_label_a_method() keeps, in the order of scenes, methods.
    std::vector<EqualTimeLook> looks;
    /// The passes after which the labels that differ from (scene, label) in `spp` alone stopped; one_label_a_method()
    /// alone fills it.
    std::map<std::pair<std::string, std::string>, std::vector<std::uint32_t>> stops;
    /// The labels by their short names; with_short_names() alone fills it.
    std::map<std::string, std::string> labels;
    std::vector<std::string> damage;  ///< messages: what is damaged, and the cell or scene that is left out
    std::size_t missing_cells = 0;    ///< cells of the experiment that are not complete

    /// The noise floor of a scene's reference, the relative
    /// squared error that is lost in its own noise; 0 if unknown.
    double noise_floor(const std::string& scene, Layer layer) const;
    /// ReferenceQuality::unjudged of a scene; empty if the reference has all light.
    Components unjudged(const std::string& scene) const;
    /// The label, with all settings, of a method in `rows`.
    const std::string& label_of(const std::string& method) const;
    /// Null if there is no such row.
    const TableRow* row(const std::string& scene, const std::string& method, Layer layer) const;
};

/// The members of a set of effects or components: "specular reflection, refraction".
template <typename Set>
std::string words_of(const Set& members, const std::string& quote = "") {
    std::string text;
    for (const auto member : members.list())
        text += (text.empty() ? "" : ", ") + quote + std::string(name_of(member)) + quote;
    std::replace(text.begin(), text.end(), '_', ' ');
    return text;
}

/// "specular reflection; light of caustic, indirect"; empty if nothing is left out.
inline std::string words_of(const LeftOut& left_out) {
    const std::string effects = words_of(left_out.effects);
    if (left_out.components.empty()) return effects;
    return effects + (effects.empty() ? "" : "; ") + "light of " + words_of(left_out.components);
}

}  // namespace gib
