#include "experiments/hard_cases/hard_case_file.h"

#include "common/core/files.h"
#include "experiments/plan/method_sweep.h"
#include "experiments/plan/run_limits.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>

namespace gib {

namespace {

/// Default of `accuracy`: a path's throughput is a product of some hundred numbers in single precision, each rounded
/// by at most 2^-24.
constexpr double rounding = 1e-5;

constexpr std::array<std::pair<Relation, std::string_view>, 4> relations = {{{Relation::equal, "expected"},
                                                                             {Relation::at_most, "at_most"},
                                                                             {Relation::black, "black"},
                                                                             {Relation::refused, "refused"}}};

const toml::node& required(const toml::table& table, const SourceLocation& where, std::string_view key) {
    const auto* node = table.get(key);
    if (!node) throw InputError(where, fmt::format("a [[case]] needs '{}'", key));
    return *node;
}

bool yes_or_no(const TomlReader& reader, const toml::node& node, std::string_view key) {
    const auto* value = node.as_boolean();
    if (!value) throw InputError(reader.at(node), fmt::format("'{}' needs true or false", key));
    return value->get();
}

void read_answer(const TomlReader& reader, const toml::table& table, const SourceLocation& where, HardCase& hard) {
    const toml::node* given = nullptr;
    for (const auto& [relation, key] : relations)
        if (const auto* node = table.get(key)) {
            if (given) throw InputError(reader.at(*node), fmt::format("a [[case]] has one answer, not '{}' too", key));
            given = node;
            hard.relation = relation;
        }
    if (!given) throw InputError(where, "a [[case]] needs 'expected', 'at_most', 'black' or 'refused'");
    switch (hard.relation) {
        case Relation::equal:
        case Relation::at_most:
            hard.expected = reader.positive_number(*given, name_of(hard.relation));
            break;
        case Relation::black:
            if (!yes_or_no(reader, *given, "black")) throw InputError(reader.at(*given), "'black' can only be true");
            break;
        case Relation::refused:
            hard.refusal = reader.string(*given, "refused");
            break;
    }
}

/// All combinations of the values in a table of parameters, whose entries are values or lists of values. Each
/// combination comes with the suffix that it gives to the case's name.
std::vector<std::pair<std::string, std::map<std::string, std::string>>> parameter_grid(const TomlReader& reader,
                                                                                       const toml::node* node) {
    std::vector<std::pair<std::string, std::map<std::string, std::string>>> grid = {{"", {}}};
    if (!node) return grid;
    for (const auto& entry : reader.entries(reader.table(*node, "set"))) {
        std::vector<std::string> values;
        const auto* list = entry.value->as_array();
        if (list) {
            for (const auto& value : reader.filled_array(*list, entry.key, "values"))
                values.push_back(reader.text_of(value));
        } else {
            values.push_back(reader.text_of(*entry.value));
        }
        if (grid.size() * values.size() > most_combinations)
            throw InputError(entry.key_at, fmt::format("the lists up to '{}' make more than {} combinations of values",
                                                       entry.key, most_combinations));
        auto smaller = std::move(grid);
        grid.clear();
        for (const auto& [name, parameters] : smaller)
            for (const auto& value : values) {
                auto more = parameters;
                more[entry.key] = value;
                grid.emplace_back(list ? name + " " + entry.key + "=" + value : name, std::move(more));
            }
    }
    return grid;
}

Effects read_effects(const TomlReader& reader, const TomlReader::Entry& entry) {
    Effects effects;
    for (const auto& value : reader.filled_array(*entry.value, entry.key, "effects")) {
        const std::string name = reader.string(value, entry.key);
        const auto effect = find_effect(name);
        if (!effect)
            throw InputError(reader.at(value),
                             fmt::format("there is no effect '{}'; `gibench list effects` has all", name));
        effects.add(*effect);
    }
    return effects;
}

void read_case(const TomlReader& reader, const toml::node& node, HardCases& file) {
    const toml::table& table = reader.table(node, "case");
    const SourceLocation where = reader.at(node);
    reader.check_keys(table, "a case",
                      {"scene", "name", "set", "expected", "at_most", "at_least", "black", "refused", "accuracy",
                       "reason", "passes", "seeds", "every_pixel", "without"});
    HardCase hard;
    const toml::node& scene = required(table, where, "scene");
    const std::filesystem::path written(reader.string(scene, "scene"));
    const auto folder = std::filesystem::path(file.path).parent_path();
    hard.scene = (written.is_absolute() ? written : folder / written).lexically_normal().string();
    if (!std::filesystem::is_regular_file(hard.scene))
        throw InputError(reader.at(scene), fmt::format("there is no scene file '{}'", hard.scene));
    read_answer(reader, table, where, hard);
    if (const auto* at_least = table.get("at_least")) {
        if (hard.relation != Relation::at_most)
            throw InputError(reader.at(*at_least), "'at_least' stands beside 'at_most' only");
        hard.at_least = reader.positive_number(*at_least, "at_least");
        if (hard.at_least > hard.expected) throw InputError(reader.at(*at_least), "'at_least' is above 'at_most'");
    }
    hard.reason = reader.string(required(table, where, "reason"), "reason");
    const auto* accuracy = table.get("accuracy");
    hard.accuracy = accuracy ? reader.positive_number(*accuracy, "accuracy") : rounding;
    const auto* passes = table.get("passes");
    hard.passes = passes ? static_cast<std::uint32_t>(reader.whole_number(*passes, "passes", 1, 1 << 20)) : 16;
    const auto* seeds = table.get("seeds");
    hard.seeds = seeds ? reader.whole_number(*seeds, "seeds", 2, most_seeds) : file.seeds;
    const auto* every_pixel = table.get("every_pixel");
    hard.every_pixel = every_pixel && yes_or_no(reader, *every_pixel, "every_pixel");
    if (const auto* without = table.get("without"))
        for (const auto& entry : reader.entries(reader.table(*without, "without")))
            hard.without[entry.key] = reader.string(*entry.value, entry.key);
    const auto* name = table.get("name");
    const std::string base = name ? reader.string(*name, "name") : written.stem().string();
    for (auto& [suffix, parameters] : parameter_grid(reader, table.get("set"))) {
        hard.name = base + suffix;
        hard.parameters = std::move(parameters);
        for (const HardCase& other : file.cases)
            if (other.name == hard.name)
                throw InputError(where, fmt::format("two cases are named '{}': give one a 'name'", hard.name));
        file.cases.push_back(hard);
    }
}

}  // namespace

std::string_view name_of(Relation relation) {
    for (const auto& [known, name] : relations)
        if (known == relation) return name;
    throw std::logic_error("an unknown relation");
}

Effects HardCases::may_leave_out(const MethodLabel& method) const {
    Effects allowed;
    for (const auto& [part, effects] : leaves_out)
        if (method.text().find(part) != std::string::npos) allowed = allowed | effects;
    return allowed;
}

bool holds_hard_cases(const std::string& path) { return TomlReader(read_file(path), path).root().contains("case"); }

HardCases parse_hard_cases(const std::string& text, const std::string& path) {
    const TomlReader reader(text, path);
    const auto& root = reader.root();
    reader.check_keys(root, "a file of hard cases",
                      {"title", "seeds", "alpha", "resolve", "method", "leaves_out", "case"});
    HardCases file;
    file.path = path;
    file.text = text;
    file.name = std::filesystem::path(path).stem().string();
    file.title = file.name;
    if (const auto* title = root.get("title")) file.title = reader.string(*title, "title");
    if (const auto* seeds = root.get("seeds")) file.seeds = reader.whole_number(*seeds, "seeds", 2, most_seeds);
    const auto share = [&](std::string_view key, double otherwise) {
        const auto* node = root.get(key);
        return node ? parse_target(reader.text_of(*node), reader.at(*node)) : otherwise;
    };
    file.alpha = share("alpha", file.alpha);
    file.resolve = share("resolve", file.resolve);
    const auto* methods = root.get("method");
    if (!methods) throw InputError({path}, "hard cases need at least one [[method]]");
    file.methods = read_methods(reader, *methods);
    if (const auto* leaves_out = root.get("leaves_out"))
        for (const auto& entry : reader.entries(reader.table(*leaves_out, "leaves_out")))
            file.leaves_out[entry.key] = read_effects(reader, entry);
    const auto* cases = root.get("case");
    if (!cases) throw InputError({path}, "a file of hard cases needs at least one [[case]]");
    for (const auto& node : reader.filled_array(*cases, "case", "[[case]] tables"))
        read_case(reader, node, file);
    return file;
}

HardCases load_hard_cases(const std::string& path) { return parse_hard_cases(read_file(path), path); }

}  // namespace gib
