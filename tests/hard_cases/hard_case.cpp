#include "tests/hard_cases/hard_case.h"

#include "common/core/files.h"
#include "common/core/parallel.h"
#include "common/reader/scene_file.h"
#include "experiments/metrics/student_t.h"
#include "experiments/plan/toml_reader.h"
#include "methods/method.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

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

std::map<std::string, std::string> texts_of(const TomlReader& reader, const toml::node* table) {
    std::map<std::string, std::string> texts;
    if (table)
        for (const auto& entry : reader.entries(reader.table(*table, "texts")))
            texts[entry.key] = reader.string(*entry.value, entry.key);
    return texts;
}

std::vector<HardCase> read_case(const TomlReader& reader, const toml::table& table, const std::string& file,
                                int seeds) {
    reader.check_keys(table, "a case",
                      {"scene", "name", "set", "expected", "at_most", "at_least", "black", "refused", "accuracy",
                       "reason", "passes", "seeds", "every_pixel", "without"});
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
    hard.without = texts_of(reader, table.get("without"));
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

HardCases load_hard_cases(const std::string& path) {
    const TomlReader reader(read_file(path), path);
    const auto& root = reader.root();
    reader.check_keys(root, "a file of hard cases", {"seeds", "alpha", "resolve", "methods", "leaves_out", "case"});
    HardCases file{.alpha = root["alpha"].value<double>().value(),
                   .resolve = root["resolve"].value<double>().value(),
                   .methods = texts_of(reader, root.get("methods")),
                   .leaves_out = {},
                   .cases = {}};
    for (const auto& entry : reader.entries(reader.table(root.at("leaves_out"), "leaves_out"))) {
        for (const auto& value : reader.filled_array(*entry.value, entry.key, "effects")) {
            const std::string name = reader.string(value, entry.key);
            const auto all = Effects::all().list();
            const auto effect = std::find_if(all.begin(), all.end(), [&](Effect e) { return name_of(e) == name; });
            if (effect == all.end()) throw InputError(reader.at(value), "there is no such effect");
            file.leaves_out[entry.key].add(*effect);
        }
    }
    for (const auto& node : reader.filled_array(root.at("case"), "case", "[[case]] tables"))
        for (auto& hard : read_case(reader, reader.table(node, "case"), path, root["seeds"].value<int>().value()))
            file.cases.push_back(std::move(hard));
    return file;
}

HardCaseImages render(const HardCase& hard, const std::string& label) {
    HardCaseImages images;
    try {
        const LoadedScene loaded = load_scene(hard.scene, {hard.parameters, std::nullopt});
        const auto method = ConfiguredMethod(MethodLabel::parse(label)).create({loaded.max_edges});
        images.missing = method->plan(*loaded.scene).missing;
        if (is_left_out(hard, images.missing)) return images;
        with_threads(1, [&] {
            for (int seed = 1; seed <= hard.seeds; ++seed) {
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
    return images;
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

}  // namespace gib::test
