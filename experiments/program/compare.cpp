#include "experiments/program/compare.h"

#include "common/core/files.h"
#include "common/core/reject.h"
#include "experiments/metrics/flip.h"
#include "experiments/metrics/robust_error.h"
#include "experiments/metrics/spectrum.h"
#include "experiments/program/compare_words.h"
#include "experiments/program/compare_z_test.h"
#include "experiments/results/judgement.h"
#include "experiments/text/json_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <ostream>

namespace gib {

namespace {

// This type keeps keys in the order of their insertion.
using Json = nlohmann::ordered_json;

/// One comparison: a layer of all tested images and the same layer of the reference.
struct Subject {
    std::vector<Image> tests;
    const ReferenceLayer& reference;
    const Denominators& denominators;
};

void put(Json& json, const std::string& name, const std::optional<Estimate>& e, bool root = false) {
    const auto value = [&](double v) { return number_to_json<Json>(root ? std::sqrt(v) : v); };
    json[name] = e ? value(e->value) : Json(nullptr);
    json[name + "_lo"] = e && e->interval ? value(e->interval->lo) : Json(nullptr);
    json[name + "_hi"] = e && e->interval ? value(e->interval->hi) : Json(nullptr);
}

/// The mean of each channel over all pixels of all images.
Json channel_means(const std::vector<Image>& images) {
    Json means = Json::array();
    for (std::size_t k = 0; k < 3; ++k) {
        double sum = 0, count = 0;
        for (const Image& image : images) {
            for (std::size_t p = 0; p < image.pixels(); ++p)
                sum += double{image.rgb[3 * p + k]};
            count += static_cast<double>(image.pixels());
        }
        means.push_back(number_to_json<Json>(sum / count));
    }
    return means;
}

/// The mean of HDR-FLIP over pixels and images, all of which must be finite.
double mean_flip(const Subject& subject) {
    double sum = 0;
    for (const Image& image : subject.tests)
        sum += hdr_flip(image, subject.reference.mean).mean();
    return sum / static_cast<double>(subject.tests.size());
}

/// Components have no FLIP, because viewers see the whole image only.
enum class Flip { measured, left_out };

Json metrics(const Subject& subject, Flip flip) {
    const double epsilon = subject.denominators.epsilon();
    const Image& r_total = subject.denominators.plain();
    const ReplicateStatistics s = replicate_statistics(subject.tests, subject.reference, subject.denominators);
    std::size_t nonfinite = 0;
    for (const Image& image : subject.tests)
        nonfinite += image.non_finite_values();
    // Values that are not finite would dominate the spectrum.
    const auto noise = nonfinite == 0 ? noise_spectrum(subject.tests, r_total) : std::nullopt;
    Json json;
    json["seeds"] = s.seeds;
    json["epsilon"] = epsilon;
    put(json, "mse", s.mse);
    put(json, "rmse", s.rmse);
    put(json, "rel_mse", s.rel_mse);
    put(json, "rel_rmse", s.rel_mse, true);
    json["rmse_corrected"] = number_to_json<Json>(s.rmse_corrected);
    json["rel_mse_corrected"] = number_to_json<Json>(s.rel_mse_corrected);
    const RobustError robust = robust_error(subject.tests, subject.reference.mean, r_total, epsilon);
    json["rel_mse_median"] = number_to_json<Json>(robust.median);
    json["rel_mse_trimmed"] = number_to_json<Json>(robust.trimmed);
    json["rel_mse_top_share"] = number_to_json<Json>(robust.share);
    put(json, "bias2", s.bias2);
    put(json, "variance", s.variance);
    json["noise_centroid"] = noise ? number_to_json<Json>(noise->centroid) : Json(nullptr);
    json["noise_low_ratio"] = noise ? number_to_json<Json>(noise->low_ratio) : Json(nullptr);
    json["flip"] = flip == Flip::measured && nonfinite == 0 ? number_to_json<Json>(mean_flip(subject)) : Json(nullptr);
    json["nonfinite"] = nonfinite;
    json["mean"] = channel_means(subject.tests);
    json["reference_mean"] = channel_means({subject.reference.mean});
    return json;
}

/// The image without the components that the reference lacks; an image without layers of
/// components as it is.
Image judged_total(const LayeredImage& file, const Reference& reference, const Judgement& judgement,
                   const std::string& path) {
    const Image* total = file.find("");
    if (!total) throw InputError({path, 0, 0}, "the image has no channels R,G,B outside its named layers");
    return reference.unresolved.empty() ? *total : judgement.total_of(file);
}

void require_comparable(const std::string& path, const Image& image, const CompareOptions& options, const Image& r) {
    if (!image.same_size(r))
        reject({}, "{} has {} x {} pixels, but {} has {} x {}", path, image.width, image.height, options.reference,
               r.width, r.height);
}

/// Throws InputError if the image and the reference say that they show different scenes.
void require_same_scene(const std::string& path, const LayeredImage& image, const CompareOptions& options,
                        const Reference& reference) {
    if (options.other_scene || !show_different_scenes(image.metadata, reference.metadata)) return;
    const auto name = [](const auto& metadata) {
        const std::string scene = attribute_in(metadata, "scene");
        return scene.empty() ? "unknown" : scene;
    };
    reject({},
           "{} ('{}') and {} ('{}') are not of the same scene, or of different versions of it; --other-scene compares "
           "them all the same",
           path, name(image.metadata), options.reference, name(reference.metadata));
}

void require_finite(const std::string& path, const std::string& layer, const ReferenceLayer& reference) {
    if (const std::size_t bad = reference.non_finite_values(); bad > 0)
        reject({path, 0, 0}, "cannot be a reference: {} values of {} are not finite", bad, layer);
}

void require_consistent(const CompareOptions& options) {
    if (options.epsilon) require_epsilon(*options.epsilon);
}

/// Throws InputError if two files have the same seed, method and scene: replicates with equal noise would seem to
/// have no noise.
void require_different_seeds(const std::vector<LayeredImage>& files, const std::vector<std::string>& paths) {
    const auto same = [](const LayeredImage& a, const LayeredImage& b, const char* key) {
        const std::string in_a = attribute_in(a.metadata, key);
        return !in_a.empty() && in_a == attribute_in(b.metadata, key);
    };
    for (std::size_t i = 0; i < files.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (same(files[i], files[j], "seed") && same(files[i], files[j], "method") &&
                same(files[i], files[j], "scene_hash"))
                reject({}, "{} and {} have the same seed: they are no replicates", paths[j], paths[i]);
}

/// The images of this layer's estimated bias, one of each file; empty if some file has none.
std::vector<Image> biases_in(const std::vector<LayeredImage>& files, const std::string& layer) {
    const std::string name = layer == total_name ? std::string(bias_layer_suffix) : bias_layer_of(layer);
    std::vector<Image> biases;
    for (const LayeredImage& file : files)
        if (const Image* bias = file.find(name)) biases.push_back(*bias);
    return biases.size() == files.size() ? biases : std::vector<Image>();
}

/// Several images of a layer are its replicates, and so are their biases; a single image may have a standard error of
/// its own.
ReferenceLayer tested_layer(const std::vector<Image>& images, const std::vector<Image>& biases,
                            const ReferenceLayer* own) {
    if (images.size() > 1) {
        ReferenceLayer layer = layer_of_groups(images);
        if (!biases.empty()) layer.bias.push_back(layer_of_groups(biases));
        return layer;
    }
    if (own) return {images.front(), own->standard_error, own->groups, own->bias};
    return {images.front(), std::nullopt, {}};
}

ZTestReport tested(const CompareOptions& options, const std::vector<std::pair<std::string, Subject>>& subjects,
                   const std::vector<LayeredImage>& files, const Reference& reference) {
    require_different_seeds(files, options.tests);
    Reference own = reference_in(files.front(), options.tests.front());
    own.unresolved = reference.unresolved;
    const Judgement judged(own);
    std::vector<ComparedLayer> layers;
    for (const auto& [name, subject] : subjects) {
        const auto c = component_named(name);
        layers.push_back(
            {name, tested_layer(subject.tests, biases_in(files, name), c ? judged.component(*c) : &judged.total()),
             &subject.reference});
    }
    return z_report(layers);
}

std::string text_of(const Json& value) { return value.is_null() ? "-" : fmt::format("{:.6g}", value.get<double>()); }

/// Prints a line for each number with its 95 % interval and, if the number depends on epsilon, with epsilon.
void print_text(const std::string& title, const Json& json, std::ostream& out) {
    const std::string epsilon = fmt::format("epsilon {:g}", json["epsilon"].get<double>());
    out << fmt::format("{}: {} image{}, {}\n", title, json["seeds"].get<int>(), json["seeds"] == 1 ? "" : "s", epsilon);
    for (const auto& [name, value] : json.items()) {
        if (name == "seeds" || name == "epsilon" || name.ends_with("_lo") || name.ends_with("_hi")) continue;
        if (value.is_object() || name.starts_with("z_")) continue;
        std::string text;
        if (value.is_array())
            for (const auto& v : value)
                text += (text.empty() ? "" : " ") + (v.is_string() ? v.get<std::string>() : text_of(v));
        else text = text_of(value);
        if (const auto lo = json.find(name + "_lo"); lo != json.end() && !lo->is_null())
            text += fmt::format("  [{}, {}]", text_of(*lo), text_of(json[name + "_hi"]));
        out << fmt::format("  {:<18} {}{}\n", name, text, name.starts_with("rel_") ? "  (" + epsilon + ")" : "");
    }
}

/// Whether a component holds no light in any image.
bool is_black(const Json& values) {
    const auto is_zero = [](const Json& v) { return v.is_number() && v.get<double>() == 0; };
    const auto all_zero = [&](const char* key) { return std::ranges::all_of(values[key], is_zero); };
    return is_zero(values["mse"]) && all_zero("mean") && all_zero("reference_mean");
}

/// Warns of what is wrong with a file, so that its numbers say little.
void warn_of_doubts(const CompareOptions& options, const std::vector<LayeredImage>& files, const Subject& total,
                    const Reference& reference) {
    if (!options.epsilon && is_black(reference.total.mean))
        std::cerr << fmt::format("warning: {}: the reference is black, and no error is a share of it\n",
                                 options.reference);
    const auto warn = [](const std::string& path, const Image& image, const Image& other) {
        if (const auto doubts = doubts_about_image(image, other); !doubts.empty())
            std::cerr << fmt::format("warning: {}: {}\n", path, doubts);
    };
    warn(options.reference, total.reference.mean, total.tests.front());
    for (std::size_t i = 0; i < files.size(); ++i) {
        warn(options.tests[i], total.tests[i], total.reference.mean);
        if (files[i].find("stderr") && !reference.total.standard_error)
            std::cerr << fmt::format(
                "warning: {} has the standard error of a reference, but {} has none: the last file is the reference\n",
                options.tests[i], options.reference);
    }
}

}  // namespace

int compare(const CompareOptions& options, std::ostream& out) {
    require_consistent(options);
    const Reference reference = read_reference(options.reference);
    require_finite(options.reference, "the image", reference.total);
    const Judgement judgement(reference);
    const Denominators& denominators = judgement.denominators(judgement.epsilon(options.epsilon));
    const Image& r = judgement.total().mean;

    std::vector<LayeredImage> files;
    std::vector<std::pair<std::string, Subject>> subjects;
    subjects.emplace_back(total_name, Subject{{}, judgement.total(), denominators});
    for (const std::string& path : options.tests) {
        files.push_back(read_image(path));
        subjects.front().second.tests.push_back(judged_total(files.back(), reference, judgement, path));
        require_comparable(path, subjects.front().second.tests.back(), options, r);
        require_same_scene(path, files.back(), options, reference);
    }
    for (Component c : all_components) {
        const std::string name(name_of(c));
        const auto has_it = [&](const LayeredImage& file) { return file.find(name) != nullptr; };
        const ReferenceLayer* layer = judgement.component(c);
        if (!layer || !std::ranges::all_of(files, has_it)) continue;
        require_finite(options.reference, name, *layer);
        subjects.emplace_back(name, Subject{{}, *layer, denominators});
        for (const LayeredImage& file : files)
            subjects.back().second.tests.push_back(*file.find(name));
    }
    const Subject& total = subjects.front().second;
    warn_of_doubts(options, files, total, reference);
    if (!options.png.empty()) {
        const auto png = encode_png(difference_image(total.tests.front(), r, denominators.epsilon()), 1.f);
        write_file(options.png, {reinterpret_cast<const char*>(png.data()), png.size()});
    }
    const bool is_relative = options.epsilon || !is_black(reference.total.mean);
    const std::string sentence = is_relative ? comparison_sentence(total.tests, total.reference, denominators)
                                             : "the reference is black: no error is a share of it";
    std::optional<ZTestReport> z;
    // Two references are always tested, with the errors of both.
    if (options.z_test || (files.size() == 1 && files.front().find("stderr") && reference.total.standard_error))
        z = tested(options, subjects, files, reference);

    Json json, components = Json::object();
    for (std::size_t i = 0; i < subjects.size(); ++i) {
        Json values = metrics(subjects[i].second, i == 0 ? Flip::measured : Flip::left_out);
        if (!is_relative)
            for (const auto& item : values.items())
                if (item.key().starts_with("rel_")) item.value() = nullptr;
        if (z && i < z->layers.size()) values.update(z->layers[i]);
        (i == 0 ? json : components[subjects[i].first]) = std::move(values);
    }
    if (!reference.unresolved.empty()) {
        json["unresolved"] = Json::array();
        for (Component c : reference.unresolved)
            json["unresolved"].push_back(std::string(name_of(c)));
    }
    const int code = options.z_test && !z->accepted ? 1 : 0;
    if (options.json) {
        json["sentence"] = sentence;
        if (z) json.update(z->json);
        json["components"] = components;
        out << json.dump(2) << '\n';
        return code;
    }
    out << sentence << "\n";
    print_text(total_name, json, out);
    for (const auto& [name, values] : components.items())
        if (is_black(values)) out << name << ": black in the images and in the reference\n";
        else print_text(name, values, out);
    out << "The names are those that `gibench list columns` explains; absolute errors are in radiance.\n";
    if (z) out << z->text;
    return code;
}

}  // namespace gib
