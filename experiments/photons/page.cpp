#include "experiments/photons/page.h"

#include "common/color/dispersion.h"
#include "common/scene/scene.h"
#include "experiments/metrics/reference_image.h"
#include "experiments/photons/surfaces.h"
#include "experiments/report/report_pictures.h"
#include "experiments/text/html.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

namespace gib {

static_assert(std::endian::native == std::endian::little, "the page reads its arrays as little-endian numbers");

namespace {

using nlohmann::json;

/// Triangles of the scene on a page, which take 9 MB in base64.
constexpr std::size_t most_triangles = 160000;
/// Pixels whose values a page has: an image of them takes 160 kB in base64.
constexpr int most_pixels = 10000;

/// The arrays of a page: each is an element with base64 that the script finds by name.
class Arrays {
public:
    template <typename T>
    void add(const std::string& name, const std::vector<T>& values) {
        const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(values.data()),
                                                  values.size() * sizeof(T));
        elements_.push_back({{"name", name}, {"text", base64(bytes)}});
    }
    /// Adds of(item) for each item.
    template <typename Item, typename Of>
    void add(const std::string& name, const std::vector<Item>& items, const Of& of) {
        std::vector<decltype(of(items.front()))> values;
        for (const Item& item : items)
            values.push_back(of(item));
        add(name, values);
    }
    const json& elements() const { return elements_; }

private:
    json elements_ = json::array();
};

using Position = std::array<float, 3>;
Position position_of(const Vec3& p) { return {p.x(), p.y(), p.z()}; }
Position color_of(const Color& c) { return {c[0], c[1], c[2]}; }
json json_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
/// A unit vector times 127.
std::array<std::int8_t, 3> bytes_of(const Vec3& n) {
    const Eigen::Vector3<std::int8_t> rounded = (127.f * n).array().round().cast<std::int8_t>();
    return {rounded.x(), rounded.y(), rounded.z()};
}

/// The view of the scene's camera: position, direction, and the angle that the image's height spans. A
/// camera with parallel rays is replaced by a distant one.
json camera_json(const Scene& scene) {
    const Sensor& sensor = scene.sensor();
    const int width = sensor.width(), height = sensor.height();
    const Vec2 half = Vec2::Constant(0.5f);
    const Ray center = sensor.generate_ray(width / 2, height / 2, half);
    const Ray top = sensor.generate_ray(width / 2, 0, half), bottom = sensor.generate_ray(width / 2, height - 1, half);
    Vec3 position = center.o, up = top.d.normalized() - bottom.d.normalized();
    double fov = std::acos(std::clamp(static_cast<double>(top.d.normalized().dot(bottom.d.normalized())), -1.0, 1.0));
    const Vec3 direction = center.d.normalized();
    if (sensor.is_orthographic() || !(fov > 0.001)) {
        fov = std::numbers::pi / 6;
        up = top.o - bottom.o;
        position = scene.bounds().center() - 2.f * scene.diagonal() * direction;
    }
    // A film of one row has no direction upwards.
    if (!(up.squaredNorm() > 0.f)) up = Frame(direction).s;
    return {{"position", json_of(position)},
            {"direction", json_of(direction)},
            {"up", json_of(up.normalized())},
            {"fov", fov * 180 / std::numbers::pi},
            {"aspect", static_cast<double>(width) / height}};
}

json surfaces_json(const Scene& scene, Arrays& arrays) {
    const SurfaceTriangles triangles = surface_triangles(scene, most_triangles);
    arrays.add("surface-positions", triangles.positions);
    arrays.add("surface-normals", triangles.normals);
    arrays.add("surface-colors", triangles.colors);
    return {{"shown", triangles.count()}, {"opaque", triangles.opaque}, {"whole", triangles.whole}};
}

std::uint8_t byte_of(std::uint32_t value) { return static_cast<std::uint8_t>(std::min(value, 255u)); }

json photons_json(const CollectedLight& light, Arrays& arrays) {
    std::vector<Position> positions;
    std::vector<std::array<std::uint8_t, 4>> powers, infos;
    std::vector<std::array<std::int8_t, 3>> normals;
    json maps = json::array();
    for (const PhotonSubset::Map& map : light.photons) {
        const double mean = map.mean_power(), per_mean = mean > 0 ? map.unit / mean : 0;
        for (const PhotonSubset::Shown& shown : map.shown) {
            const Photon& photon = shown.photon;
            positions.push_back(position_of(photon.p));
            normals.push_back(bytes_of(photon.surface_normal()));
            powers.push_back(rgbe_of(per_mean * photon.power().cast<double>()));
            const std::uint32_t bounces = photon.edges - 1u;
            const auto stratum = static_cast<std::uint32_t>(photon.stratum() ? *photon.stratum() + 1 : 0);
            infos.push_back({byte_of(bounces), byte_of(static_cast<std::uint32_t>(maps.size())), byte_of(stratum),
                             byte_of(shown.pass)});
        }
        maps.push_back({{"name", map.name},
                        {"shown", map.shown.size()},
                        {"stored", map.stored},
                        {"emitted", map.emitted},
                        {"mean_power", mean},
                        {"power_unit", map.name == "volume" ? "W × scene unit" : "W"}});
    }
    arrays.add("photon-positions", positions);
    arrays.add("photon-normals", normals);
    arrays.add("photon-powers", powers);
    arrays.add("photon-infos", infos);
    return maps;
}

json beams_json(const CollectedLight& light, Arrays& arrays) {
    std::vector<Position> ends;
    for (const StoredBeams::Beam& beam : light.beams.beams)
        for (const Vec3& end : {beam.from, beam.to})
            ends.push_back(position_of(end));
    arrays.add("beam-ends", ends);
    arrays.add("beam-powers", light.beams.beams, [](const StoredBeams::Beam& beam) { return color_of(beam.power); });
    return {{"stored", light.stored_beams}, {"shown", light.beams.beams.size()}, {"emitted", light.beams.emitted}};
}

void add_records(const std::vector<StoredRecord>& records, Arrays& arrays) {
    arrays.add("record-positions", records, [](const StoredRecord& r) { return position_of(r.p); });
    arrays.add("record-normals", records, [](const StoredRecord& r) { return position_of(r.n); });
    arrays.add("record-irradiances", records, [](const StoredRecord& r) { return color_of(r.irradiance); });
    arrays.add("record-radii", records, [](const StoredRecord& r) { return r.radius; });
}

void add_patches(const StoredPatches& patches, Arrays& arrays) {
    arrays.add("patch-corners", patches.corners, position_of);
    arrays.add("patch-radiosities", patches.radiosity, color_of);
    arrays.add("patch-indices", patches.patches);
}

/// Adds the places where the rays through the middles of the pixels first meet a surface: points, not a number where
/// they meet none, normals towards the camera, and how the surface reflects: 0 not at all, 1 only specularly, 2
/// diffusely, so that an estimate is made there.
void add_pixel_places(const Scene& scene, const PixelGrid& grid, Arrays& arrays) {
    std::vector<Position> points;
    std::vector<std::array<std::int8_t, 3>> normals;
    std::vector<std::uint8_t> reflections;
    for (std::size_t i = 0; i < grid.count(); ++i) {
        const Ray ray = scene.sensor().generate_ray(grid.x(i), grid.y(i), Vec2::Constant(0.5f));
        const auto hit = scene.intersect(ray);
        const Vec3 n = hit ? normal_towards(*hit, -ray.d) : Vec3(Vec3::Zero());
        points.push_back(position_of(hit ? hit->p : Vec3(Vec3::Constant(std::numeric_limits<float>::quiet_NaN()))));
        normals.push_back(bytes_of(n));
        const LobeTraits lobes = hit ? hit->bsdf->traits_at(-hit->shading.to_local(ray.d).z()) : LobeTraits();
        reflections.push_back(lobes.diffuse ? 2 : lobes.specular() ? 1 : 0);
    }
    arrays.add("pixel-points", points);
    arrays.add("pixel-normals", normals);
    arrays.add("pixel-reflections", reflections);
}

/// The method's image by component: names of arrays.
json estimate_json(const PageContent& content, Arrays& arrays) {
    if (!content.estimate) return nullptr;
    const ShownImage& estimate = *content.estimate;
    const Scene& scene = *content.scene.scene;
    const PixelGrid grid(scene.sensor().width(), scene.sensor().height(), most_pixels);
    add_pixel_places(scene, grid, arrays);
    json names = json::object();
    for (Component c : all_components) {
        if (!estimate.image[c] || is_black(*estimate.image[c])) continue;
        const std::string name(name_of(c));
        std::vector<Position> values;
        for (std::size_t i = 0; i < grid.count(); ++i)
            values.push_back(
                color_of(estimate.image[c]->at(static_cast<std::size_t>(grid.y(i) * grid.width + grid.x(i)))));
        arrays.add("pixels-" + name, values);
        names[name] = "pixels-" + name;
    }
    return {{"k", estimate.k ? json(*estimate.k) : json(nullptr)},
            {"passes", estimate.passes},
            {"emitted", estimate.emitted},
            {"radii", estimate.radii},
            {"gather", estimate.gather},
            {"grid", {grid.columns, grid.rows, grid.width, grid.height}},
            {"image", std::move(names)}};
}

/// Wavelength [nm] and colour of each stratum.
json strata_json() {
    json strata = json::array();
    for (int i = 0; i < wavelength_strata; ++i) {
        const Color& weight = stratum_weight(i);
        const Color color = weight / std::max(weight.maxCoeff(), 1e-6f);
        strata.push_back({{"wavelength", stratum_wavelength(i)}, {"color", {color[0], color[1], color[2]}}});
    }
    return strata;
}

std::string data_url(std::string_view script) {
    return "data:text/javascript;base64," +
           base64({reinterpret_cast<const std::uint8_t*>(script.data()), script.size()});
}

}  // namespace

std::array<std::uint8_t, 4> rgbe_of(const Colord& color) {
    if (!color.isFinite().all() || !(color.maxCoeff() > 0)) return {0, 0, 0, 0};
    int e = std::ilogb(color.maxCoeff()) + 1;
    if (std::lround(std::ldexp(color.maxCoeff(), 8 - e)) > 255) ++e;
    if (e < -127) return {0, 0, 0, 0};
    e = std::min(e, 127);
    std::array<std::uint8_t, 4> packed{};
    for (int i = 0; i < 3; ++i) {
        const double mantissa = std::min(std::ldexp(std::max(color[i], 0.0), 8 - e), 255.0);
        packed[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(std::lround(mantissa));
    }
    packed[3] = static_cast<std::uint8_t>(e + 128);
    return packed;
}

std::string photons_page(const PageContent& content) {
    const CollectedLight& light = content.light;
    const Scene& scene = *content.scene.scene;
    Arrays arrays;
    json facts = {{"scene", content.scene.name},
                  {"method", content.method},
                  {"seed", content.seed},
                  {"passes", light.passes},
                  {"photons_of_passes", light.photons_of_passes},
                  {"camera", camera_json(scene)},
                  {"center", json_of(scene.bounds().empty() ? Vec3(Vec3::Zero()) : scene.bounds().center())},
                  {"diagonal", scene.diagonal()},
                  {"surfaces", surfaces_json(scene, arrays)},
                  {"maps", photons_json(light, arrays)},
                  {"beams", beams_json(light, arrays)},
                  {"dispersive", scene.has_dispersion()},
                  {"strata", strata_json()},
                  {"estimate", estimate_json(content, arrays)},
                  {"records", light.records.size()},
                  {"patches", light.patches.patches.size()}};
    add_records(light.records, arrays);
    add_patches(light.patches, arrays);
    const json imports = {{"imports",
                           {{"three", data_url(embedded_file("three.js"))},
                            {"three/orbit-controls", data_url(embedded_file("OrbitControls.js"))}}}};
    const json values = {
        {"title", html_escape(content.method + " in " + content.scene.name)},
        {"scene", html_escape(content.scene.name)},
        {"method", html_escape(content.method)},
        {"style",
         std::string(embedded_file("report_page/scheme.css")) + std::string(embedded_file("photons_page/page.css"))},
        {"facts", script_safe_json(facts.dump())},
        {"arrays", arrays.elements()},
        {"imports", imports.dump()},
        {"script", embedded_scripts({"report_page/core.js", "report_page/controls.js", "photons_page/data.js",
                                     "photons_page/photons.js", "photons_page/solids.js", "photons_page/view.js",
                                     "photons_page/panel.js", "photons_page/estimates.js", "photons_page/page.js"})}};
    return filled(embedded_file("photons_page/page.html"), values,
                  [](std::string_view text) { return std::string(text); });
}

}  // namespace gib
