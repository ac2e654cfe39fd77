#include "methods/parts/vertices/connections.h"

#include "methods/parts/transport/dispersed_path.h"

#include <cmath>

namespace gib {

namespace {

/// The share of light that passes along the segment way(), by channel. It is made where it is used, so that it stays in
/// registers.
template <typename Way>
Color transmitted(RayQueries& rays, const Way& way, const Medium* medium, NumberStream& flights) {
    return rays.scene().has_media() ? rays.transmittance(way(), medium, flights) : rays.visibility(way());
}

constexpr std::array lobe_kinds = {LobeKind::diffuse, LobeKind::specular};

const Color& of(const LobeValues& f, LobeKind kind) { return kind == LobeKind::diffuse ? f.diffuse : f.specular; }

/// Adds the light of a path for each kind of lobe at its vertex, whose class is class_of(kind).
template <typename ClassOf>
void add_classes(PixelSample& light, const LobeValues& f, const Color& rest, const ClassOf& class_of) {
    for (const LobeKind kind : lobe_kinds) {
        const Color value = of(f, kind) * rest;
        if (!is_black(value)) light[class_of(kind).component()] += value;
    }
}

bool is_within(const Sensor& sensor, const ReconstructionFilter::Pixel& pixel) {
    return pixel.weight > 0.f && pixel.x >= 0 && pixel.y >= 0 && pixel.x < sensor.width() && pixel.y < sensor.height();
}

/// A point as the camera sees it through one pixel.
struct PixelView {
    Sensor::View view;
    std::size_t pixel;
    double density;  ///< Sensor::ray_density() times the sum of filters over the pixels
};
/// `at_infinity`: p stands for a light at infinity, which is behind everything that the far clip distance cuts off.
std::optional<PixelView> view_of(const Sensor& sensor, const Vec3& p, const CameraNumbers& u,
                                 bool at_infinity = false) {
    const auto view = sensor.view_of(p, u.lens);
    if (!view || !(view->distance > view->ray.t_min)) return std::nullopt;
    if (!at_infinity && !(view->distance < view->ray.t_max)) return std::nullopt;
    // Points far outside the image, whose pixel may not even be a number, are left out at once.
    const Vec2 margin = Vec2::Constant(sensor.filter().radius() + 1.f);
    const Vec2 size(static_cast<float>(sensor.width()), static_cast<float>(sensor.height()));
    if (!((view->film + margin).array() > 0.f).all() || !((size + margin - view->film).array() > 0.f).all())
        return std::nullopt;
    const auto pixel = sensor.filter().choose_pixel(view->film, u.pixel);
    if (!is_within(sensor, pixel)) return std::nullopt;
    return PixelView{*view,
                     static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(sensor.width()) +
                         static_cast<std::size_t>(pixel.x),
                     sensor.ray_density(view->ray.d) * double{pixel.weight}};
}

}  // namespace

std::optional<Connection> connect_to_light(RayQueries& rays, const PathVertex& eye, const LightPaths& paths,
                                           const PathRules& rules, const VertexNumbers& u, NumberStream& flights) {
    const Scene& scene = rays.scene();
    const auto light = scene.sample_light(eye.lit(scene), u.light_choice(), u.light_position());
    if (!light || is_black(light->Le)) return std::nullopt;
    const Vec3 wi_local = eye.to_local(light->wi);
    const LobeValues scattered = scattered_to_camera(eye, light->wi, wi_local);
    if (is_black(scattered.sum())) return std::nullopt;
    const auto way = [&] { return Segment{eye.origin(light->wi), light->target, light->wi, light->distance}; };
    const Color visible = transmitted(rays, way, eye.medium_towards(scene, light->wi), flights);
    if (is_black(visible)) return std::nullopt;

    Connection path;
    add_classes(path.light, scattered, eye.beta * light->Le * visible / light->pdf_w,
                [&](LobeKind kind) { return eye.ending_with(kind); });
    const DirectionPdfs pdf = direction_pdfs(eye, eye.from_local, wi_local);
    const bool is_point = light->delta && std::isfinite(light->distance);
    const double sampling = double{light->pdf_w} * (is_point ? double{light->distance} * double{light->distance} : 1.);
    const Vec3& emitting = std::isfinite(light->distance) ? light->target : eye.p;
    const double emission = paths.emission.density(light->light, emitting, -light->wi, light->cos_light);
    const double by_hit = light->delta ? 0 : squared(pdf.to_light / sampling);  // (44)
    // In a direction along the light's surface, emission has density 0 and cosine 0; their ratio is taken for 0.
    const double step =
        emission > 0 ? emission * double{eye.cosine(light->wi)} / (sampling * double{light->cos_light}) : 0;
    const double samples = eye.is_first && light->delta ? rules.first_samples() : 1;
    const double by_light_walk = squared(step / samples) * eye.sums.earlier(pdf.to_camera);  // (45)
    path.weight = static_cast<float>(1 / (1 + by_hit + by_light_walk));                      // (37)
    return path;
}

std::optional<Connection> connect(RayQueries& rays, const PathVertex& eye, const PathVertex& light,
                                  const LightPaths& paths, const PathRules& rules, double factor,
                                  ConnectionRoulette& roulette, NumberStream& flights) {
    if (!can_join(eye.stratum, light.stratum)) return std::nullopt;
    const Vec3 between = light.p - eye.p;
    if (!eye.faces(between) || !light.faces(-between)) return std::nullopt;
    const float distance2 = between.squaredNorm();
    if (!(distance2 > 0.f)) return std::nullopt;
    const float distance = std::sqrt(distance2);
    const Vec3 w = between / distance, w_eye = eye.to_local(w), w_light = light.to_local(-w);
    const LobeValues at_eye = scattered_to_camera(eye, w, w_eye);
    if (is_black(at_eye.sum())) return std::nullopt;
    const LobeValues at_light = scattered_from_light(light, -w, w_light);
    if (is_black(at_light.sum()) || are_level(eye, light, between)) return std::nullopt;

    // The densities per area at each end are those per solid angle times these.
    const double per_distance2 = 1 / double{distance2}, per_area_at_light = double{light.cosine(w)} * per_distance2,
                 per_area_at_eye = double{eye.cosine(w)} * per_distance2;
    const DirectionPdfs eye_pdf = direction_pdfs(eye, eye.from_local, w_eye),
                        light_pdf = direction_pdfs(light, w_light, light.from_local);
    const double by_camera =
        squared(eye_pdf.to_light * per_area_at_light) * light.sums.earlier(light_pdf.to_light);  // (40)
    const double by_light =
        squared(light_pdf.to_camera * per_area_at_eye) * eye.sums.earlier(eye_pdf.to_camera);  // (41)
    const double samples = eye.is_first ? rules.first_samples() : 1;
    Connection path;
    path.weight = static_cast<float>(1 / (1 + (by_camera + by_light) / squared(samples)));  // (37)
    Color rest = eye.beta * light.beta * joint_weight(eye.stratum, light.stratum) *
                 static_cast<float>(factor * paths.power * per_area_at_light);
    const double survival = roulette.survival(double{path.weight * (at_eye.sum() * at_light.sum() * rest).sum()});
    if (!(survival > 0)) return std::nullopt;

    const Vec3 origin = eye.origin(w);
    const auto way = [&] { return Segment{origin, light.target(origin), w, distance}; };
    const Color visible = transmitted(rays, way, eye.medium_towards(rays.scene(), w), flights);
    if (is_black(visible)) return std::nullopt;
    rest *= visible / static_cast<float>(survival);
    for (const LobeKind kind : lobe_kinds) {
        const Color& f = of(at_eye, kind);
        if (is_black(f)) continue;
        const PathClass first = eye.ending_with(kind);
        add_classes(path.light, {f * at_light.diffuse, f * at_light.specular}, rest,
                    [&](LobeKind last) { return first.followed_by(light.beginning_with(last)); });
    }
    return path;
}

std::optional<Splat> connect_to_camera(RayQueries& rays, const PathVertex& light, const LightPaths& paths,
                                       const PathRules& rules, const SplatFilm& film, const CameraNumbers& u,
                                       NumberStream& flights) {
    const Sensor& sensor = rays.scene().sensor();
    if (light.hit && rays.scene().hidden_from_camera(*light.hit)) return std::nullopt;
    const auto seen = view_of(sensor, light.p, u);
    if (!seen) return std::nullopt;
    const Ray& ray = seen->view.ray;
    const Vec3 to_camera = light.to_local(-ray.d);
    const LobeValues scattered = scattered_from_light(light, -ray.d, to_camera);
    if (is_black(scattered.sum())) return std::nullopt;
    film.prefetch(seen->pixel, light.beginning_with(LobeKind::diffuse).component());
    const Color visible = rays.transmittance_to_camera(ray, light.target(ray.o), paths.camera_on_surface, flights);
    if (is_black(visible)) return std::nullopt;

    const double distance = sensor.is_orthographic() ? 1. : double{seen->view.distance};
    const double per_area = double{light.cosine(ray.d)} / (distance * distance);
    Splat splat{.pixel = seen->pixel, .connection = {}};
    add_classes(splat.connection.light, scattered,
                light.beta * visible * static_cast<float>(paths.power * seen->density * per_area),
                [&](LobeKind kind) { return light.beginning_with(kind); });
    if (!light.sums.has_others()) return splat;
    const double step = sensor.ray_density(ray.d) * per_area / paths.count;
    const double reverse = direction_pdfs(light, to_camera, light.from_local).to_light;
    const double others = squared(step) * light.earlier_at_first(reverse, rules.first_samples());  // (46)
    splat.connection.weight = static_cast<float>(1 / (1 + others));  // (37), with (47): the camera's part is 0
    return splat;
}

std::optional<Splat> sample_light_from_camera(RayQueries& rays, const LightPaths& paths, const SplatFilm& film,
                                              bool is_found_too, const VertexNumbers& u, NumberStream& flights) {
    const Scene& scene = rays.scene();
    const Sensor& sensor = scene.sensor();
    if (sensor.is_orthographic() || sensor.hides_emitters()) return std::nullopt;
    const Vec2 lens = u.bsdf_direction();
    const auto light = scene.sample_light(sensor.lens_point(lens), u.light_choice(), u.light_position());
    if (!light || light->delta || is_black(light->Le)) return std::nullopt;
    if (is_found_too && !std::isfinite(light->distance)) return std::nullopt;
    const auto seen = view_of(sensor, light->target, {lens, u.roulette()}, !std::isfinite(light->distance));
    if (!seen) return std::nullopt;
    film.prefetch(seen->pixel, Component::emission);
    Color visible = rays.transmittance_to_camera(seen->view.ray, light->target, paths.camera_on_surface, flights);
    if (scene.has_media() && !std::isfinite(light->distance))
        if (const Medium* beyond =
                rays.medium_at(light->target))  // it has no boundary, as the target is outside of all
            visible *= beyond->transmittance(light->target, seen->view.ray.d, infinity, flights);
    if (is_black(visible)) return std::nullopt;
    Splat splat{.pixel = seen->pixel, .connection = {.light = {}, .weight = 1.f}};
    splat.connection.light[Component::emission] =
        light->Le * visible * static_cast<float>(seen->density / double{light->pdf_w});
    // Densities of this direction [1/sr] in a pass: ray_density() by the camera's walks, count pdf_w by light sampling.
    const double by_walk = sensor.ray_density(seen->view.ray.d) / (paths.count * double{light->pdf_w});
    if (is_found_too) splat.connection.weight = static_cast<float>(1 / (1 + squared(by_walk)));
    return splat;
}

}  // namespace gib
