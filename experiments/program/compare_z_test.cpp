#include "experiments/program/compare_z_test.h"

#include "experiments/metrics/z_statistic.h"
#include "experiments/text/json_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace gib {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<const char*, scale_count> scale_keys = {"z_blocks", "z_regions", "z_image"};
constexpr std::array<const char*, 3> rgb_names = {"R", "G", "B"};

std::string line(const std::string& name, const std::string& text) { return fmt::format("  {:<18} {}\n", name, text); }

/// The text "3 to 5" for `count` = 3 pixels from `first` = 3 on.
std::string range_text(int first, int count) { return fmt::format("{} to {}", first, first + count - 1); }

std::string share_text(double share) { return fmt::format("{:+.4g} %", 100 * share); }

std::string interval_text(const MeanDeviation& mean) {
    if (!mean.interval) return "[unknown]";
    return fmt::format("[{}, {}]", share_text(mean.interval->lo), share_text(mean.interval->hi));
}

/// How the noise of the tested images is known.
std::string noise_source(const ReferenceLayer& x, const ReferenceLayer& r) {
    if (!x.standard_error) return "scatter";
    return r.standard_error ? (x.groups.size() > 1 ? "replicates" : "standard_error") : "scatter";
}

std::string noise_text(const ReferenceLayer& x, const ReferenceLayer& r) {
    const std::string source = noise_source(x, r);
    if (source == "replicates") return fmt::format("known from {} replicates", x.groups.size());
    if (source == "standard_error") return "known from its standard error";
    return std::string("estimated from the scatter within blocks (pixels taken as independent") +
           (r.standard_error ? ")" : "; the reference has no standard error)");
}

void put_scale(Json& json, const std::string& key, const ZTestVerdict::Scale& scale) {
    const BlockTest& test = scale.largest;
    json[key + "_tests"] = scale.hypotheses;
    json[key + "_rejected"] = scale.rejected;
    json[key + "_t"] = number_to_json<Json>(test.t);
    json[key + "_p"] = test.p;
    json[key + "_p_corrected"] = scale.adjusted_p;
    json[key + "_layer"] = scale.layer;
    json[key + "_channel"] = rgb_names[test.channel];
    json[key + "_x"] = test.x;
    json[key + "_y"] = test.y;
    json[key + "_width"] = test.width;
    json[key + "_height"] = test.height;
}

Json layer_json(const LayerZTest& layer) {
    Json json;
    for (std::size_t s = 0; s < scale_count; ++s) {
        double smallest = 1, within = 0;
        for (const BlockTest& test : layer.tests[s]) {
            smallest = std::min(smallest, test.p);
            within += test.holds_zero ? 1 : 0;
        }
        json[std::string(scale_keys[s]) + "_smallest_p"] = smallest;
        // The share of the blocks whose 95 % interval holds no difference.
        json[std::string(scale_keys[s]) + "_within"] = within / static_cast<double>(layer.tests[s].size());
    }
    for (const char* key : {"z_deviation", "z_deviation_lo", "z_deviation_hi", "z_reference_share"})
        json[key] = Json::array();
    for (const MeanDeviation& mean : layer.means) {
        json["z_deviation"].push_back(number_to_json<Json>(mean.value));
        json["z_deviation_lo"].push_back(mean.interval ? number_to_json<Json>(mean.interval->lo) : Json(nullptr));
        json["z_deviation_hi"].push_back(mean.interval ? number_to_json<Json>(mean.interval->hi) : Json(nullptr));
        json["z_reference_share"].push_back(mean.reference_share);
    }
    return json;
}

std::string scale_text(const ZTestVerdict::Scale& scale) {
    const BlockTest& test = scale.largest;
    return fmt::format(
        "{} tests, {} rejected; smallest p {:.2g} (corrected {:.2g}) at t = {:.2f}: {} of {}, x {}, y {}",
        scale.hypotheses, scale.rejected, test.p, scale.adjusted_p, test.t, rgb_names[test.channel], scale.layer,
        range_text(test.x, test.width), range_text(test.y, test.height));
}

/// The reason for the verdict: `text` for people, `kind` for programs.
struct Reason {
    std::string kind, text;
};

Reason reason_of(const ZTestVerdict& verdict, const LayerZTest& total, const ZTestLimits& limits) {
    const std::string margin = fmt::format("{:g} %", 100 * limits.margin);
    if (verdict.accepted())
        return {"accepted", fmt::format("accepted: no difference found, and the means agree within {}", margin)};
    std::string differences, noisy;
    double largest_share = 0;
    const auto add = [](std::string& list, const std::string& text) { list += (list.empty() ? "" : ", ") + text; };
    for (std::size_t s = 0; s < scale_count; ++s)
        if (const auto& scale = verdict.scales[s]; scale.rejected > 0)
            add(differences, fmt::format("{} of {} tests of {}", scale.rejected, scale.hypotheses, scale_names[s]));
    for (std::size_t k = 0; k < 3; ++k) {
        const MeanDeviation& mean = total.means[k];
        const auto& i = mean.interval;
        if (i && i->lo >= -limits.margin && i->hi <= limits.margin) continue;
        add(noisy, fmt::format("{} {} {}", rgb_names[k], share_text(mean.value), interval_text(mean)));
        largest_share = std::max(largest_share, mean.reference_share);
    }
    if (!noisy.empty() && verdict.differs) add(differences, "deviation of the mean " + noisy);
    if (verdict.differs) return {"differs", "rejected: the images differ: " + differences};
    return {
        "too_noisy",
        fmt::format("rejected: not enough samples to show that the means agree within {}: the interval is {}; {:.0f} % "
                    "of the variance is the reference's",
                    margin, noisy, 100 * largest_share)};
}

}  // namespace

ZTestReport z_report(const std::vector<ComparedLayer>& layers) {
    const ZTestLimits limits;
    ZTestReport report;
    std::size_t nonfinite = 0;
    for (const ComparedLayer& layer : layers)
        nonfinite += layer.x.non_finite_values();
    const ComparedLayer& total = layers.front();
    report.json = {{"z_test", "blocks"},
                   {"z_accepted", false},
                   {"z_verdict", "not_finite"},
                   {"z_reason", ""},
                   {"z_alpha", limits.alpha},
                   {"z_margin", limits.margin},
                   {"z_noise", noise_source(total.x, *total.r)}};
    report.text =
        fmt::format("z-test: gibench's own, of blocks and means; alpha {:g} for all tests together\n", limits.alpha) +
        line("noise of the test", noise_text(total.x, *total.r));
    if (nonfinite > 0) {
        const std::string reason = fmt::format("rejected: {} values of the test are not finite", nonfinite);
        report.json["z_reason"] = reason;
        report.text += line("verdict", reason);
        return report;
    }
    std::vector<std::pair<std::string, LayerZTest>> tested;
    for (const ComparedLayer& layer : layers) {
        tested.emplace_back(layer.name, z_test(layer.x, *layer.r, total.r->mean));
        report.layers.push_back(layer_json(tested.back().second));
    }
    const ZTestVerdict verdict = verdict_of(tested, limits);
    const LayerZTest& first = tested.front().second;
    const Reason reason = reason_of(verdict, first, limits);
    report.accepted = verdict.accepted();
    report.json["z_accepted"] = report.accepted;
    report.json["z_verdict"] = reason.kind;
    report.json["z_reason"] = reason.text;
    report.json["z_shared_noise"] = first.shared_noise;
    if (first.shared_noise > 1)
        report.text +=
            line("shared by pixels", fmt::format("the variance of block means is {:.3g} times that of independent "
                                                 "pixels",
                                                 first.shared_noise));
    for (std::size_t s = 0; s < scale_count; ++s) {
        put_scale(report.json, scale_keys[s], verdict.scales[s]);
        report.text += line(scale_names[s], scale_text(verdict.scales[s]));
    }
    for (std::size_t k = 0; k < 3; ++k)
        report.text += line(fmt::format("mean of {}", rgb_names[k]),
                            fmt::format("{}  {}", share_text(first.means[k].value), interval_text(first.means[k])));
    report.text += line("verdict", reason.text);
    if (verdict.differs && !total.x.standard_error)
        report.text += line("",
                            "(with one image, noise that pixels share, as photon maps have it, counts as a "
                            "difference: give several seeds)");
    return report;
}

}  // namespace gib
