#include "experiments/hard_cases/hard_case.h"

#include "common/core/parallel.h"
#include "common/reader/scene_file.h"
#include "experiments/measuring/measurement_json.h"
#include "experiments/metrics/student_t.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace gib {

using nlohmann::json;

namespace {

/// Adds the statistics of one seed's image.
void add_image(HardCaseImages& images, const Image& image, const NonFinite& dropped) {
    images.not_finite += dropped.count;
    double sum = 0;
    for (std::size_t i = 0; i < image.pixels(); ++i) {
        const Colord color = image.at(i).cast<double>();
        for (const double x : color) {
            if (!std::isfinite(x)) ++images.not_finite;
            else if (x < 0) ++images.negative;
        }
        const double mean = color.mean();
        images.smallest = std::min(images.smallest, mean);
        images.largest = std::max(images.largest, mean);
        sum += mean;
    }
    images.means.push_back(sum / static_cast<double>(image.pixels()));
}

HardCaseVerdict failed(HardCaseVerdict verdict, std::string why) {
    verdict.verdict = Verdict::fails;
    verdict.why = std::move(why);
    return verdict;
}

/// A verdict that holds, with the mean of the seeds and the half width of its interval.
HardCaseVerdict mean_of_seeds(const std::vector<double>& means, double tail) {
    const SampleMean mean = sample_mean(means);
    return {.verdict = Verdict::holds, .got = mean.value, .half_width = half_width({mean.variance}, tail), .why = ""};
}

/// Judges whether the mean and, with `every_pixel`, every pixel agree with the expected number.
HardCaseVerdict judge_number(const HardCase& hard, const HardCaseImages& images, const HardCaseVerdict& found,
                             double resolve) {
    const double rounding = hard.accuracy * hard.expected, mean = *found.got;
    if (mean - found.half_width > hard.expected + rounding)
        return failed(found, fmt::format("{:.4g} % too bright", 100 * (mean / hard.expected - 1)));
    const bool bound = hard.relation == Relation::at_most;
    const double least = bound ? hard.at_least : hard.expected;
    if (mean + found.half_width < least - rounding)
        return failed(found, fmt::format("{:.4g} % too dark", 100 * (1 - mean / least)));
    if (!bound && hard.every_pixel &&
        (images.smallest < hard.expected - rounding || images.largest > hard.expected + rounding))
        return failed(found, fmt::format("pixels from {:.6g} to {:.6g}", images.smallest, images.largest));
    const bool is_resolved = bound
                                 ? mean + found.half_width <= (1 + resolve) * hard.expected &&
                                       (hard.at_least == 0 || mean - found.half_width >= (1 - resolve) * hard.at_least)
                                 : found.half_width <= resolve * hard.expected;
    if (is_resolved) return found;
    HardCaseVerdict verdict = found;
    verdict.verdict = Verdict::unresolved;
    verdict.why = bound ? fmt::format("may be more than {:.3g} % outside of its bounds", 100 * resolve)
                        : fmt::format("the interval is {:.3g} % wide to either side, more than {:.3g} %",
                                      100 * found.half_width / hard.expected, 100 * resolve);
    return verdict;
}

HardCaseVerdict judge_omission(Effects missing, Effects may_leave_out) {
    const Effects more = missing - may_leave_out;
    if (!more.empty()) return failed({}, fmt::format("leaves out {}, which `leaves_out` does not allow", more.names()));
    return {.verdict = Verdict::left_out, .got = std::nullopt, .why = "leaves out " + missing.names()};
}

Effects effects_from_json(const json& names) {
    Effects effects;
    for (const json& name : names) {
        const auto effect = find_effect(name.get<std::string>());
        if (!effect) throw std::invalid_argument("there is no effect " + name.dump());
        effects.add(*effect);
    }
    return effects;
}

}  // namespace

HardCaseImages render_hard_case(const HardCase& hard, const MethodLabel& label, int seeds, int threads) {
    HardCaseImages images;
    images.smallest = std::numeric_limits<double>::infinity();
    images.largest = -images.smallest;
    const auto start = std::chrono::steady_clock::now();
    try {
        const LoadedScene loaded = load_scene(hard.scene, {hard.parameters, std::nullopt});
        const MethodDescription& description = find_method(label.name);
        const auto method = description.create(ParameterValues(all_parameters(description), label), {loaded.max_edges});
        images.missing = method->plan(*loaded.scene).missing;
        if (!images.missing.empty()) return images;
        with_threads(threads, [&] {
            for (int seed = 1; seed <= seeds; ++seed) {
                StageTimes stages;
                const auto run = method->start(*loaded.scene, static_cast<std::uint64_t>(seed), stages);
                for (std::uint32_t pass = 0; pass < hard.passes; ++pass)
                    if (run->advance(pass) == Progress::converged) break;
                add_image(images, run->image().total(), run->counts().non_finite);
            }
        });
    } catch (const InputError& error) {
        images.refusal = error.what();
    }
    images.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return images;
}

json to_json(const HardCaseImages& images) {
    json missing = json::array(), means = json::array();
    for (const Effect effect : images.missing.list())
        missing.push_back(name_of(effect));
    for (const double mean : images.means)
        means.push_back(number_to_json(mean));
    return {{"refusal", images.refusal},
            {"missing", missing},
            {"means", means},
            {"smallest", number_to_json(images.smallest)},
            {"largest", number_to_json(images.largest)},
            {"not_finite", images.not_finite},
            {"negative", images.negative},
            {"seconds", images.seconds}};
}

HardCaseImages images_from_json(const json& j) {
    HardCaseImages images;
    images.refusal = j.at("refusal");
    images.missing = effects_from_json(j.at("missing"));
    for (const auto& mean : j.at("means"))
        images.means.push_back(number_from_json(mean));
    images.smallest = number_from_json(j.at("smallest"));
    images.largest = number_from_json(j.at("largest"));
    images.not_finite = j.at("not_finite");
    images.negative = j.at("negative");
    images.seconds = j.at("seconds");
    return images;
}

std::string_view name_of(Verdict verdict) {
    switch (verdict) {
        case Verdict::holds:
            return "holds";
        case Verdict::fails:
            return "fails";
        case Verdict::unresolved:
            return "unresolved";
        case Verdict::left_out:
            return "left out";
        case Verdict::not_judged:
            return "not judged";
    }
    throw std::logic_error("an unknown verdict");
}

std::optional<std::string> exclusion(const HardCase& hard, const MethodLabel& method) {
    const std::string label = method.text();
    for (const auto& [part, why] : hard.without)
        if (label.find(part) != std::string::npos) return why;
    return std::nullopt;
}

HardCaseVerdict judge(const HardCase& hard, const HardCaseImages& images, double tail, double resolve,
                      Effects may_leave_out) {
    if (hard.relation == Relation::refused) {
        if (images.refusal.empty()) return failed({}, "not refused");
        if (images.refusal.find(hard.refusal) == std::string::npos) return failed({}, "refused: " + images.refusal);
        return {.verdict = Verdict::holds, .got = std::nullopt, .why = images.refusal};
    }
    if (!images.refusal.empty()) return failed({}, "refused: " + images.refusal);
    if (!images.missing.empty()) return judge_omission(images.missing, may_leave_out);
    const HardCaseVerdict found = mean_of_seeds(images.means, tail);
    if (images.not_finite > 0) return failed(found, fmt::format("{} values are not finite", images.not_finite));
    if (images.negative > 0) return failed(found, fmt::format("{} values are negative", images.negative));
    if (hard.relation != Relation::black) return judge_number(hard, images, found, resolve);
    return images.largest == 0 ? found : failed(found, fmt::format("a pixel of {:.3g}", images.largest));
}

}  // namespace gib
