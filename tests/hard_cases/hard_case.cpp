#include "tests/hard_cases/hard_case.h"

#include "common/core/files.h"
#include "common/core/parallel.h"
#include "common/reader/scene_file.h"
#include "experiments/metrics/student_t.h"
#include "experiments/plan/toml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

namespace gib::test {

namespace {

/// Default of `accuracy`: a path's throughput is a product of some hundred numbers in single precision, each rounded
/// by at most 2^-24.
constexpr double rounding = 1e-5;

/// The value of a key, or `otherwise` if the key is missing. Throws InputError if the value has another type.
template <typename T>
T given_or(const TomlReader& reader, const toml::table& table, const char* key, T otherwise) {
    const auto* node = table.get(key);
    if (!node) return otherwise;
    const auto value = node->value<T>();
    if (!value) throw InputError(reader.at(*node), fmt::format("'{}' has the wrong type", key));
    return *value;
}

void read_answer(const TomlReader& reader, const toml::table& table, HardCase& hard) {
    int answers = 0;
    const auto is_given = [&](const char* key, Relation relation) {
        if (!table.contains(key)) return false;
        ++answers;
        hard.relation = relation;
        return true;
    };
    if (is_given("expected", Relation::equal))
        hard.expected = reader.positive_number(*table.get("expected"), "expected");
    if (is_given("at_most", Relation::at_most))
        hard.expected = reader.positive_number(*table.get("at_most"), "at_most");
    if (is_given("refused", Relation::refused)) hard.refusal = reader.string(*table.get("refused"), "refused");
    if (is_given("black", Relation::black) && !given_or(reader, table, "black", true))
        throw InputError(reader.at(table), "'black' can only be true");
    if (answers != 1) throw InputError(reader.at(table), "a [[case]] has one answer");
    hard.at_least = given_or(reader, table, "at_least", 0.0);
    if (table.contains("at_least") && hard.relation != Relation::at_most)
        throw InputError(reader.at(table), "'at_least' needs 'at_most'");
}

/// One case for each value of each list among the parameters. Such values stand in the names.
std::vector<HardCase> with_parameters(const TomlReader& reader, const HardCase& hard, const toml::table* parameters) {
    std::vector<HardCase> cases = {hard};
    if (!parameters) return cases;
    for (const auto& entry : reader.entries(*parameters)) {
        std::vector<HardCase> more;
        const auto add = [&](const toml::node& value, bool is_of_list) {
            for (HardCase one : cases) {
                one.parameters[entry.key] = reader.text_of(value);
                if (is_of_list) one.name += " " + entry.key + "=" + reader.text_of(value);
                more.push_back(std::move(one));
            }
        };
        if (const auto* list = entry.value->as_array())
            for (const auto& value : *list)
                add(value, true);
        else add(*entry.value, false);
        cases = std::move(more);
    }
    return cases;
}

/// A table of values by pass of a plan; `read` reads a value.
template <typename Read>
auto by_pass(const TomlReader& reader, const toml::table& table, const char* key, const Read& read) {
    std::map<std::string, decltype(read(table, ""))> values;
    if (const auto* passes = table.get(key))
        for (const auto& entry : reader.entries(reader.table(*passes, key))) {
            const auto methods = methods_under_test();
            if (std::none_of(methods.begin(), methods.end(), [&](const auto& m) { return m.runs(entry.key); }))
                throw InputError(reader.at(*entry.value), "no method has this pass");
            values[entry.key] = read(*entry.value, entry.key);
        }
    return values;
}

std::vector<std::string> variants_of(const TomlReader& reader, const toml::node* names) {
    std::vector<std::string> variants;
    if (!names) return variants;
    const auto known = look_up_variants(Work::small);
    for (const auto& node : reader.filled_array(*names, "variants", "names of variants")) {
        variants.push_back(reader.string(node, "variants"));
        if (variants.back() != "all" && std::none_of(known.begin(), known.end(), [&](const auto& variant) {
                return variant.name == variants.back();
            }))
            throw InputError(reader.at(node), "there is no such variant");
    }
    return variants;
}

std::vector<HardCase> read_case(const TomlReader& reader, const toml::table& table, const std::string& file,
                                int seeds) {
    reader.check_keys(table, "a case",
                      {"scene", "name", "set", "expected", "at_most", "at_least", "black", "refused", "accuracy",
                       "reason", "passes", "passes_with", "seeds", "every_pixel", "seldom", "variants", "without"});
    HardCase hard;
    const std::filesystem::path scene(reader.string(table.at("scene"), "scene"));
    hard.scene = (std::filesystem::path(file).parent_path() / scene).lexically_normal().string();
    hard.name = given_or(reader, table, "name", scene.stem().string());
    read_answer(reader, table, hard);
    hard.accuracy = given_or(reader, table, "accuracy", rounding);
    hard.reason = given_or(reader, table, "reason", std::string());
    hard.passes = given_or(reader, table, "passes", 16u);
    hard.seeds = given_or(reader, table, "seeds", seeds);
    hard.every_pixel = given_or(reader, table, "every_pixel", false);
    hard.seldom = given_or(reader, table, "seldom", false);
    hard.variants = variants_of(reader, table.get("variants"));
    hard.passes_with = by_pass(reader, table, "passes_with", [&](const toml::node& value, std::string_view pass) {
        return static_cast<std::uint32_t>(reader.whole_number(value, pass, 1, 1 << 20));
    });
    hard.without = by_pass(reader, table, "without",
                           [&](const toml::node& value, std::string_view pass) { return reader.string(value, pass); });
    const auto* set = table.get("set");
    return with_parameters(reader, hard, set ? &reader.table(*set, "set") : nullptr);
}

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

/// Describes the error if the mean or, with `every_pixel`, a pixel disagrees with the expected number.
std::string problem_of_number(const HardCase& hard, const HardCaseImages& images, double mean, double half_width,
                              double resolve) {
    const double tolerance = hard.accuracy * hard.expected;
    if (mean - half_width > hard.expected + tolerance)
        return fmt::format("{:.4g} % too bright", 100 * (mean / hard.expected - 1));
    if (hard.relation == Relation::not_above) return "";
    const bool bound = hard.relation == Relation::at_most;
    const double least = bound ? hard.at_least : hard.expected;
    if (mean + half_width < least - tolerance) return fmt::format("{:.4g} % too dark", 100 * (1 - mean / least));
    if (!bound && hard.every_pixel &&
        (images.smallest < hard.expected - tolerance || images.largest > hard.expected + tolerance))
        return fmt::format("pixels from {:.6g} to {:.6g}", images.smallest, images.largest);
    const bool is_resolved = bound ? mean + half_width <= (1 + resolve) * hard.expected &&
                                         (hard.at_least == 0 || mean - half_width >= (1 - resolve) * hard.at_least)
                                   : half_width <= resolve * hard.expected;
    return is_resolved ? "" : fmt::format("not resolved to {:.3g} %", 100 * resolve);
}

}  // namespace

std::uint32_t HardCase::passes_of(const MethodUnderTest& method) const {
    const auto found = std::find_if(passes_with.begin(), passes_with.end(),
                                    [&](const auto& entry) { return method.runs(entry.first); });
    return found == passes_with.end() ? passes : found->second;
}

bool HardCase::is_for(const MethodUnderTest& method) const {
    return std::none_of(without.begin(), without.end(), [&](const auto& entry) { return method.runs(entry.first); });
}

bool HardCase::is_for_variant(const MethodUnderTest& variant) const {
    return std::any_of(variants.begin(), variants.end(), [&](const std::string& named) {
        return named == variant.name || (named == "all" && is_for(variant));
    });
}

HardCases load_hard_cases(const std::string& path) {
    const TomlReader reader(read_file(path), path);
    const auto& root = reader.root();
    reader.check_keys(root, "a file of hard cases", {"seeds", "alpha", "resolve", "case"});
    HardCases file{.alpha = root["alpha"].value<double>().value(),
                   .resolve = root["resolve"].value<double>().value(),
                   .cases = {}};
    for (const auto& node : reader.filled_array(root.at("case"), "case", "[[case]] tables"))
        for (auto& hard : read_case(reader, reader.table(node, "case"), path, root["seeds"].value<int>().value()))
            file.cases.push_back(std::move(hard));
    return file;
}

std::optional<HardCase> case_for(const HardCase& hard, const MethodUnderTest& method, const Plan& plan) {
    if (hard.relation == Relation::black)
        return plan.missing.has(Effect::participating_media) ? std::nullopt : std::optional(hard);
    const bool is_complete = plan.unresolved.empty();
    if (!plan.missing.empty() || !(is_complete || method.description->unbiased)) return std::nullopt;
    HardCase held = hard;
    held.every_pixel &= method.samples_pixels();
    const bool reaches_seldom = hard.seldom || plan.called_for.has(Effect::glossy_lobes);
    if (!is_complete || (reaches_seldom && !method.samples_pixels())) held.relation = Relation::not_above;
    return held;
}

const LoadedScene& scene_of(const HardCase& hard) {
    using Key = std::pair<std::string, std::map<std::string, std::string>>;
    static std::optional<std::pair<Key, LoadedScene>> last;
    const Key key{hard.scene, hard.parameters};
    if (!last || last->first != key) last.emplace(key, load_scene(hard.scene, {hard.parameters, std::nullopt}));
    return last->second;
}

Verdict judge(const HardCase& hard, const HardCaseImages& images, double tail, double resolve) {
    if (hard.relation == Relation::refused) {
        if (images.refusal.empty()) return {"not refused"};
        if (images.refusal.find(hard.refusal) == std::string::npos) return {"refused: " + images.refusal};
        return {};
    }
    if (!images.refusal.empty()) return {"refused: " + images.refusal};
    const SampleMean mean = sample_mean(images.means);
    Verdict verdict{"", mean.value, half_width({mean.variance}, tail)};
    if (images.not_finite > 0) verdict.problem = fmt::format("{} values are not finite", images.not_finite);
    else if (images.negative > 0) verdict.problem = fmt::format("{} values are negative", images.negative);
    else if (hard.relation != Relation::black)
        verdict.problem = problem_of_number(hard, images, verdict.got, verdict.half_width, resolve);
    else if (images.largest != 0) verdict.problem = fmt::format("a pixel of {:.3g}", images.largest);
    return verdict;
}

Verdict render_and_judge(const HardCase& hard, const MethodUnderTest& method, double tail, double resolve) {
    const LoadedScene& loaded = scene_of(hard);
    const auto configured = ConfiguredMethod(MethodLabel::parse(method.label)).create({loaded.max_edges});
    const bool may_need_more = !method.samples_pixels() && hard.relation != Relation::not_above;
    const std::uint32_t fewest = hard.passes_of(method), most = may_need_more ? 64 * fewest : fewest;
    struct Seed {
        StageTimes stages;
        std::unique_ptr<Run> run;
    };
    std::vector<std::unique_ptr<Seed>> seeds(static_cast<std::size_t>(hard.seeds));
    Verdict verdict;
    with_threads(1, [&] {
        for (std::uint32_t done = 0, passes = fewest; passes <= most; done = passes, passes *= 4) {
            HardCaseImages images;
            for (std::size_t i = 0; i < seeds.size(); ++i) {
                if (!seeds[i]) {
                    seeds[i] = std::make_unique<Seed>();
                    seeds[i]->run = configured->start(*loaded.scene, i + 1, seeds[i]->stages);
                }
                Run& run = *seeds[i]->run;
                for (std::uint32_t pass = done; pass < passes; ++pass)
                    if (run.advance(pass) == Progress::converged) break;
                add_image(images, run.image().total(), run.counts().non_finite);
                if (passes == most) seeds[i].reset();
            }
            verdict = judge(hard, images, tail, resolve);
            if (verdict.problem.empty()) return;
        }
    });
    return verdict;
}

}  // namespace gib::test
