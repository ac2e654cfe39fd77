// Laws that hold for the photon mapper with any options: every combination that its parameter table allows is tried.

#include "tests/support/scene_fixtures.h"

#include <algorithm>

namespace gib::options_test {
namespace {

using test::mean_of;
using test::render;

const std::vector<std::string> gathering = {"source", "cache", "spacing"};

bool is_one_of(const std::string& name, const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

bool has(const std::string& label, const char* option) { return label.find(option) != std::string::npos; }

/// `start` with every combination of values of the parameters that `counts` accepts. The values are a parameter's
/// choices; if they stand beside a number, that number's default is one, too.
template <typename Counts>
std::vector<std::string> combined(const std::string& start, Counts&& counts) {
    std::vector<std::string> labels = {start};
    for (const Parameter& p : find_method("photon_mapper").parameters) {
        std::vector<std::string> values = p.choices;
        if (values.empty() || !counts(p.name)) continue;
        if (p.kind != Parameter::Kind::choice) values.push_back(p.default_value);
        std::vector<std::string> extended;
        for (const auto& label : labels)
            for (const auto& value : values)
                extended.push_back(label + " " + p.name + "=" + value);
        labels = std::move(extended);
    }
    return labels;
}

/// All combinations for density estimates without final gathering, and for final gathering those of its own options
/// and of the options that affect it.
std::vector<std::string> combinations() {
    auto labels = combined("photon_mapper", [](const std::string& name) {
        // Shadow photons have tests of their own. Without them, the option `shadows` is refused.
        return !is_one_of(name, gathering) && name != "shadows";
    });
    auto gathered = combined("photon_mapper gather=32", [](const std::string& name) {
        return is_one_of(name, gathering) || name == "area" || name == "projection";
    });
    // Estimates at the end of every gather ray are slow, so fewer rays are used there. The records of a cache are
    // few; 8 rays would be too noisy for 1.5 % of the image's mean.
    for (std::string& label : gathered)
        if (has(label, "source=photons") && has(label, "cache=off"))
            label.replace(label.find("gather=32"), 9, "gather=8");
    // The method refuses these, because there are no records to space.
    std::erase_if(gathered,
                  [](const std::string& label) { return has(label, "cache=off") && has(label, "spacing=diagonals"); });
    for (std::string& label : gathered)
        if (has(label, "cache=off")) label.erase(label.find(" spacing="));
    labels.insert(labels.end(), gathered.begin(), gathered.end());
    // The method refuses these, because all photons within the radius count and there is nothing to choose.
    std::erase_if(labels, [](const std::string& label) {
        return label.find("k=all") != std::string::npos && label.find("compensation=on") != std::string::npos;
    });
    return labels;
}

TEST(PhotonOptions, CoverWhatTheTableOffers) {
    const auto labels = combinations();
    EXPECT_GE(labels.size(), 16u);
    for (const char* option : {"k=auto", "kernel=cone", "kernel=gaussian", "area=plain"})
        EXPECT_TRUE(std::any_of(labels.begin(), labels.end(), [&](const auto& label) { return has(label, option); }))
            << option;
}

TEST(PhotonOptions, WithoutEffectAreRefused) {
    const std::pair<const char*, const char*> refused[] = {
        {"shadows=guide", "'shadows' has no effect with shadow_photons=0"},
        {"shadow_k=8", "'shadow_k' has no effect with shadow_photons=0"},
        {"source=paths", "'source' has no effect with gather=0"},
        {"cache=on", "'cache' has no effect with gather=0"},
        {"gather=8 accuracy=0.2", "'accuracy' has no effect with cache=off"},
        {"photons=0 gather=8", "'gather' has no effect with photons=0, unless source=paths"},
        {"photons=0 caustic_photons=9 radius=0.1", "'radius' has no effect with photons=0"},
        {"caustic_photons=0 caustic_radius=0.1", "'caustic_radius' has no effect with caustic_photons=0"},
        {"volume_photons=0 volume_radius=0.1", "'volume_radius' has no effect with volume_photons=0"},
        {"photons=0 volume_photons=9 area=plain", "'area' has no effect with no photons on surfaces"},
        {"photons=0 kernel=cone", "'kernel' has no effect with no photons"},
        {"k=all compensation=on", "'compensation' has no effect with k=all"},
    };
    for (const auto& [parameters, message] : refused)
        try {
            ConfiguredMethod(MethodLabel::parse(std::string("photon_mapper ") + parameters)).create({});
            ADD_FAILURE() << parameters;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
        }
    for (const char* kept : {"shadow_photons=9 shadows=skip shadow_k=8", "photons=0 gather=8 source=paths cache=on",
                             "photons=0 caustic_photons=9 caustic_radius=0.1 k=8 kernel=cone area=plain"})
        EXPECT_NO_THROW(ConfiguredMethod(MethodLabel::parse(std::string("photon_mapper ") + kept)).create({})) << kept;
}

// The radiance is 1 everywhere, and indirect light is rho^2 = 1/4 of it; 1e5 photons give it within 0.3 %. Whole
// discs are too dark along the edges of the box, or too bright if they count the photons of the next wall (plain).
TEST(PhotonOptions, FurnaceHasTheAnalyticRadiance) {
    const auto furnace = test::shipped_scene("furnace.xml", {{}, std::pair{16, 16}});
    for (const auto& label : combinations()) {
        const Image indirect = *render(furnace, label + " photons=100000 radius=0.03", 4)[Component::indirect];
        const double mean = 4 * mean_of(indirect).mean();
        EXPECT_GT(mean, has(label, "area=surface") ? 0.985 : 0.95) << label;
        EXPECT_LT(mean, has(label, "area=plain") ? 1.04 : 1.015) << label;
    }
}

// The image's mean is the path tracer's, so no option loses a path class or counts it twice.
TEST(PhotonOptions, MeanAgreesWithThePathTracer) {
    const auto glass = test::shipped_scene("cornell-glass.xml", {{}, std::pair{24, 24}});
    const double truth = mean_of(render(glass, "path", 1024).total()).mean();
    for (const auto& label : combinations()) {
        const double mean =
            mean_of(render(glass, label + " photons=20000 radius=0.03 caustic_radius=0.02", 4).total()).mean();
        EXPECT_NEAR(mean / truth, 1, has(label, "area=surface") ? 0.03 : 0.06) << label;
    }
}

TEST(PhotonOptions, ImagesAreTheSameForAnyNumberOfThreads) {
    for (const char* file : {"cornell-glass.xml", "fog.xml"}) {
        const auto scene = test::shipped_scene(file, {{}, std::pair{20, 20}});
        for (const auto& label : combinations()) {
            const std::string small = label + " photons=6000 radius=0.02 caustic_radius=0.02";
            // A pass sees the records that the passes before it added to the cache.
            const std::uint32_t passes = has(label, "cache=on") ? 3 : 1;
            const Image one = render(scene, small, passes, 1, 1).total();
            for (int threads : {2, 5})
                ASSERT_EQ(one.rgb, render(scene, small, passes, 1, threads).total().rgb) << label << ' ' << threads;
        }
    }
}

}  // namespace
}  // namespace gib::options_test
