#include "tests/noise/noise_table.h"

#include "common/core/files.h"
#include "common/core/math.h"
#include "common/core/parallel.h"
#include "common/reader/scene_file.h"
#include "experiments/filter/checkpoint_filter.h"
#include "experiments/metrics/epsilon.h"
#include "experiments/plan/toml_reader.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <filesystem>
#include <optional>

namespace gib::test {

namespace {

constexpr double scatters_in_range = 3.5;
constexpr double trimmed_share = 0.002;

std::map<std::string, std::string> read_parameters(const TomlReader& reader, const toml::table& table) {
    std::map<std::string, std::string> parameters;
    if (const auto* set = table.get("set"))
        for (const auto& entry : reader.entries(reader.table(*set, "set")))
            parameters[entry.key] = reader.text_of(*entry.value);
    return parameters;
}

std::optional<Component> read_component(const TomlReader& reader, const toml::table& table) {
    const auto* node = table.get("component");
    if (!node) return {};
    const std::string name = reader.string(*node, "component");
    for (const Component c : all_components)
        if (name_of(c) == name) return c;
    throw InputError(reader.at(*node), "there is no such component");
}

NoiseRow read_row(const TomlReader& reader, const toml::table& table, const std::string& file) {
    reader.check_keys(table, "a row",
                      {"name", "method", "scene", "set", "component", "resolution", "passes", "seeds", "trimmed",
                       "quick", "idea", "figure", "scatter"});
    const auto node = [&](const char* key) -> const toml::node& {
        if (const auto* found = table.get(key)) return *found;
        throw InputError(reader.at(table), std::string("a row needs '") + key + "'");
    };
    const auto whole = [&](const toml::node& of, const char* key) { return reader.whole_number(of, key, 1, 1 << 20); };
    const auto& size = reader.filled_array(node("resolution"), "resolution", "two numbers");
    if (size.size() != 2) throw InputError(reader.at(size), "'resolution' needs two numbers");
    const auto folder = std::filesystem::path(file).parent_path();
    return {
        .name = reader.string(node("name"), "name"),
        .label = reader.string(node("method"), "method"),
        .scene = (folder / reader.string(node("scene"), "scene")).lexically_normal().string(),
        .parameters = read_parameters(reader, table),
        .resolution = {whole(size[0], "resolution"), whole(size[1], "resolution")},
        .component = read_component(reader, table),
        .passes = static_cast<std::uint32_t>(whole(node("passes"), "passes")),
        .seeds = static_cast<std::uint64_t>(whole(node("seeds"), "seeds")),
        .trimmed = table["trimmed"].value_or(false),
        .quick = table["quick"].value_or(false),
        .idea = reader.string(node("idea"), "idea"),
        .figure = reader.positive_number(node("figure"), "figure"),
        .scatter = reader.positive_number(node("scatter"), "scatter"),
    };
}

/// The scene of a row, which is kept until that of another row is asked for.
const LoadedScene& scene_of(const NoiseRow& row) {
    using Key = std::tuple<std::string, std::map<std::string, std::string>, std::pair<int, int>>;
    static std::optional<std::pair<Key, LoadedScene>> last;
    const Key key{row.scene, row.parameters, row.resolution};
    if (!last || last->first != key) last.emplace(key, load_scene(row.scene, {row.parameters, row.resolution}));
    return last->second;
}

struct CountedImage {
    Image image;
    std::uint64_t rays;
};

CountedImage image_of(const NoiseRow& row, const LoadedScene& loaded, std::uint64_t seed) {
    const ConfiguredMethod configured(MethodLabel::parse(row.label));
    StageTimes stages;
    const auto run = configured.create({loaded.max_edges})->start(*loaded.scene, seed, stages);
    const bool is_filtered = configured.values.given("filter");
    CheckpointFilter filter(*loaded.scene, seed, {.non_local_means = is_filtered});
    filter.prepare(stages);
    for (std::uint32_t pass = 0; pass < row.passes; ++pass) {
        const bool is_last = run->advance(pass) == Progress::converged || pass + 1 == row.passes;
        if (is_filtered && (is_last || std::has_single_bit(pass + 1))) filter.keep(pass + 1, run->image());
        if (is_last) break;
    }
    const ComponentImages image = is_filtered ? filter.filtered(row.passes, run->image()) : run->image();
    return {row.component ? *image[*row.component] : image.total(), run->counts().rays};
}

/// P(Z > x) of a standard normal Z.
double tail(double x) { return 0.5 * std::erfc(x / std::numbers::sqrt2); }

}  // namespace

std::pair<double, double> NoiseRow::range() const {
    const double factor = std::exp(scatters_in_range * scatter);
    return {figure / factor, figure * factor};
}

std::vector<NoiseRow> load_noise_table(const std::string& path) {
    const TomlReader reader(read_file(path), path);
    reader.check_keys(reader.root(), "a table of noise", {"row"});
    std::vector<NoiseRow> rows;
    for (const auto& node : reader.filled_array(reader.root().at("row"), "row", "[[row]] tables"))
        rows.push_back(read_row(reader, reader.table(node, "row"), path));
    return rows;
}

NoiseLook look_at(const NoiseRow& row, std::uint64_t first_seed) {
    const LoadedScene& loaded = scene_of(row);
    std::vector<Image> images(row.seeds);
    std::atomic<std::uint64_t> rays = 0;
    parallel_blocks(row.seeds, 1, [&](std::size_t i, std::size_t, std::size_t) {
        CountedImage counted = image_of(row, loaded, first_seed + i);
        images[i] = std::move(counted.image);
        rays += counted.rays;
    });
    const auto samples = static_cast<double>(row.seeds * images[0].pixels() * row.passes);
    return {relative_variance(images, row.trimmed), static_cast<double>(rays) / samples};
}

double relative_variance(const std::vector<Image>& images, bool trimmed) {
    const auto n = static_cast<double>(images.size());
    const std::size_t values = images[0].rgb.size();
    Image mean = images[0];
    std::vector<double> variances(values);
    for (std::size_t i = 0; i < values; ++i) {
        double sum = 0, squares = 0;
        for (const Image& image : images)
            sum += double{image.rgb[i]};
        for (const Image& image : images)
            squares += sqr(double{image.rgb[i]} - sum / n);
        mean.rgb[i] = static_cast<float>(sum / n);
        variances[i] = squares / (n - 1);
    }
    const double epsilon = epsilon_of({}, mean);
    std::vector<double> pixels(mean.pixels());
    for (std::size_t i = 0; i < values; ++i)
        pixels[i / 3] += variances[i] / (3 * (sqr(double{mean.rgb[i]}) + epsilon));
    std::sort(pixels.begin(), pixels.end());
    if (trimmed)
        pixels.resize(pixels.size() -
                      static_cast<std::size_t>(std::ceil(trimmed_share * static_cast<double>(pixels.size()))));
    double sum = 0;
    for (const double pixel : pixels)
        sum += pixel;
    return sum / static_cast<double>(pixels.size());
}

double failure_probability(const NoiseRow& row, double factor) {
    const double shift = std::log(factor) / row.scatter;
    return sqr(tail(scatters_in_range + shift) + tail(scatters_in_range - shift));
}

}  // namespace gib::test
