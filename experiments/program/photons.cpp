#include "experiments/program/photons.h"

#include "common/core/files.h"
#include "common/core/parallel.h"
#include "experiments/measuring/measure.h"
#include "experiments/photons/page.h"
#include "experiments/program/commands.h"
#include "experiments/system/progress.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iostream>

namespace gib {

namespace {

void print_what_is_shown(const CollectedLight& light, std::ostream& out) {
    for (const PhotonSubset::Map& map : light.photons)
        out << fmt::format("{} map: {} of {} photons shown ({:.3g} %)\n", map.name, map.shown.size(), map.stored,
                           100 * static_cast<double>(map.shown.size()) / static_cast<double>(map.stored));
    if (!light.records.empty()) out << fmt::format("irradiance records: {}\n", light.records.size());
    if (!light.patches.patches.empty())
        out << fmt::format("patches: {}, corners: {}\n", light.patches.patches.size(), light.patches.corners.size());
    if (light.passes > 0) out << fmt::format("passes: {}\n", light.passes);
}

void warn_of_what_is_not(const CollectedLight& light, const std::string& method, ProgressLine& progress) {
    if (light.empty())
        progress.message(fmt::format("warning: '{}' stores no light in this scene; skipped: {}", method,
                                     fmt::join(light.skipped, ", ")));
    for (const PhotonSubset::Map& map : light.photons)
        if (map.not_finite > 0)
            progress.message(
                fmt::format("warning: {} photons of the {} map have no finite power and are shown with "
                            "power 0",
                            map.not_finite, map.name));
}

}  // namespace

int show_photons(const PhotonsOptions& options, std::ostream& out) {
    const ConfiguredMethod method(MethodLabel::parse(options.method));
    require_stored_light(method.label);
    method.values.refuse({"filter"}, "photons: no image is made");
    check_writable(options.out, ".html");
    const LoadedScene scene = loaded_with_warnings(options.scene, options.loading);
    ProgressLine progress;
    const StoredLightWork work{
        .scene = scene,
        .method = method,
        .seed = options.seed,
        .most_passes = options.passes.value_or(std::min(last_pass(method.values, scene.sample_count), default_passes)),
        .most_photons = options.most_photons,
        .listener = [&](std::string_view stage, double fraction) {
            progress.update(fraction, std::nullopt, fmt::format("{}, {}: {}", scene.name, options.method, stage));
        }};
    with_threads(options.threads, [&] {
        const CollectedLight light = collect_stored_light(work);
        warn_of_what_is_not(light, options.method, progress);
        write_file(options.out, photons_page({scene, method.label.text(), options.seed, light}));
        print_what_is_shown(light, out);
    });
    progress.message(options.out);
    return 0;
}

}  // namespace gib
