#include "experiments/program/photons.h"

#include "common/core/files.h"
#include "common/core/parallel.h"
#include "common/scene/scene.h"
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

/// Throws InputError if the file is no image of the scene in the size of its film.
Reference reference_of(const LoadedScene& loaded, const std::string& path) {
    const Scene& scene = *loaded.scene;
    Reference reference = read_reference(path);
    const Image& image = reference.total.mean;
    if (image.width != scene.sensor().width() || image.height != scene.sensor().height())
        throw InputError({path},
                         fmt::format("the reference has {} x {} pixels, but the scene's image {} x {}; --resolution "
                                     "changes that",
                                     image.width, image.height, scene.sensor().width(), scene.sensor().height()));
    const auto hash = reference.metadata.find("scene_hash");
    if (hash != reference.metadata.end() && hash->second != loaded.content_hash)
        throw InputError({path}, "the reference is of another scene, or of another version of it");
    return reference;
}

}  // namespace

int show_photons(const PhotonsOptions& options, std::ostream& out) {
    const ConfiguredMethod method(MethodLabel::parse(options.method));
    require_stored_light(method.label);
    method.values.refuse({"filter"}, "photons: no image is made");
    check_writable(options.out, ".html");
    const LoadedScene scene = loaded_with_warnings(options.scene, options.loading);
    std::optional<Reference> reference;
    if (!options.reference.empty()) reference = reference_of(scene, options.reference);
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
        const Estimates estimates = estimates_of(
            {.scene = scene,
             .method = method,
             .seed = options.seed,
             .passes = light.passes > 0 ? light.passes
                                        : std::min(work.most_passes, options.passes.value_or(default_image_passes)),
             .varies_k = !light.photons.empty(),
             .observer = [&](const OngoingWork& ongoing) { work.listener(ongoing.stage, ongoing.fraction); }});
        write_file(options.out, photons_page({scene, method.label.text(), options.seed, light, &estimates,
                                              reference ? &*reference : nullptr}));
        print_what_is_shown(light, out);
    });
    progress.message(options.out);
    return 0;
}

}  // namespace gib
