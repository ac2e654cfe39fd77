#include "methods/parts/photons/projection_map.h"

#include "common/core/parallel.h"
#include "common/scene/scene.h"

#include <algorithm>
#include <numeric>

namespace gib {

namespace {

/// A light that keeps more of its cells than this is not worth aiming.
constexpr double all_but_kept = 0.98;
/// It is given up when this share of the cells has been made.
constexpr std::size_t trial_share = 4;
/// A tenth of the choices goes to all lights alike, as without projection maps (see Scene).
constexpr double uniform_share = 0.1;

/// x in [lower, upper) for u in [0, 1).
float within(const EmissionBox& box, std::size_t i, float u) {
    const float x = box.lower[i] + u * box.width(i);
    return x < box.upper[i] ? x : std::nextafter(box.upper[i], 0.f);
}

}  // namespace

/// Halves the cells that hold most power, and drops what cannot reach a target, until there are enough of them.
class ProjectionMap::Refinement {
public:
    Refinement(const Scene& scene, TargetSurfaces surfaces, const std::vector<OfLight>& lights, std::size_t most_cells)
        : scene_(scene), targets_(scene, surfaces), lights_(lights), most_cells_(most_cells) {
        double total = 0;
        for (const OfLight& light : lights)
            total += light.power;
        for (std::size_t i = 0; i < lights.size(); ++i) {
            const auto* area = std::get_if<AreaLight>(&scene.lights()[i]);
            const bool blind = area && cannot_see_itself(*area, scene.shapes());
            except_.push_back(blind ? area->shape : ProjectionTargets::no_shape);
            Growing cell{{{}, static_cast<std::uint32_t>(i)}, lights[i].power / total};
            if (lights[i].power > 0 && look(cell)) cells_.push_back(cell);
        }
    }

    std::vector<Cell> run() {
        bool tried = false;
        for (double threshold = 0.5; !cells_.empty() && threshold > 1e-12;) {
            std::vector<std::size_t> heavy;
            for (std::size_t i = 0; i < cells_.size(); ++i)
                if (!cells_[i].finished && cells_[i].weight > threshold) heavy.push_back(i);
            if (heavy.empty()) {
                threshold *= 0.5;
                continue;
            }
            if (cells_.size() + heavy.size() > most_cells_) break;
            halve(heavy);
            if (!tried && cells_.size() > most_cells_ / trial_share) {
                give_up_idle_lights();
                tried = true;
            }
        }
        give_up_idle_lights();
        std::vector<Cell> result;
        for (const Growing& cell : cells_)
            result.push_back(cell.cell);
        return result;
    }

private:
    struct Growing {
        Cell cell;
        double weight;           ///< its share of all lights' power
        bool finished = false;   ///< there is nothing to gain by halving it
        std::uint32_t hint = 0;  ///< the target that it was seen to reach
    };

    const Light& light_of(const Growing& cell) const { return scene_.lights()[cell.cell.light]; }

    /// Whether the cell's rays can reach a target.
    bool look(Growing& cell) const {
        const RayBundle bundle = emission_bundle(light_of(cell), scene_.shapes(), cell.cell.box);
        const auto reach = targets_.reach(bundle, except_[cell.cell.light], cell.hint);
        cell.finished = reach == ProjectionTargets::Reach::all_meet;
        return reach != ProjectionTargets::Reach::none;
    }

    struct Halves {
        std::array<Growing, 2> cells;
        std::array<bool, 2> kept = {false, false};
    };

    std::optional<std::pair<EmissionBox, EmissionBox>> cut(const Growing& cell, std::size_t dimension) const {
        const EmissionBox& box = cell.cell.box;
        const float at = split_point(light_of(cell), scene_.shapes(), box, dimension);
        if (!(at > box.lower[dimension] && at < box.upper[dimension])) return std::nullopt;
        std::pair<EmissionBox, EmissionBox> halves{box, box};
        halves.first.upper[dimension] = at;
        halves.second.lower[dimension] = at;
        return halves;
    }

    /// How wide a bundle is where the targets are [scene units].
    double spread(const Growing& cell, const EmissionBox& box) const {
        const RayBundle bundle = emission_bundle(light_of(cell), scene_.shapes(), box);
        const double distance =
            std::max((targets_.center().cast<double>() - bundle.center).norm(), static_cast<double>(targets_.radius()));
        return bundle.radius + 2 * std::sin(0.5 * std::min(bundle.cone.half_angle, std::numbers::pi)) * distance;
    }

    /// In the dimension without whose extent the rays would be narrowest: halving it may narrow nothing yet, as of a
    /// ring around an axis. Of equals, the one in which the box is longest.
    Halves halves_of(const Growing& cell) const {
        const auto dimensions = emission_dimensions(light_of(cell));
        std::optional<std::pair<EmissionBox, EmissionBox>> best;
        double least = 0;
        float longest = 0.f;
        for (std::size_t i = 0; i < 4; ++i) {
            const float extent = cell.cell.box.width(i);
            if (!dimensions[i]) continue;
            const auto halves = cut(cell, i);
            if (!halves) continue;
            EmissionBox thin = cell.cell.box;  // not in its middle, where a light's map may have an edge
            thin.lower[i] += 0.25f * extent;
            thin.upper[i] = thin.lower[i] + extent / 64;
            const double width = spread(cell, thin);
            const bool equal = best && std::abs(width - least) <= 1e-6 * least;
            if (best && (equal ? extent <= longest : width > least)) continue;
            best = halves;
            least = width;
            longest = extent;
        }
        Halves result{{cell, cell}};
        if (!best) {  // as fine as float can be
            result.cells[0].finished = true;
            result.kept[0] = true;
            return result;
        }
        const double volume = cell.cell.box.volume();
        for (std::size_t side = 0; side < 2; ++side) {
            Growing& half = result.cells[side];
            half.cell.box = side == 0 ? best->first : best->second;
            half.weight = cell.weight * (half.cell.box.volume() / volume);
            result.kept[side] = look(half);
        }
        return result;
    }

    /// In the order of the cells: the map is the same for any number of threads.
    void halve(const std::vector<std::size_t>& chosen) {
        std::vector<Halves> halves(chosen.size());
        parallel_blocks(chosen.size(), 32, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t i = begin; i < end; ++i)
                halves[i] = halves_of(cells_[chosen[i]]);
        });
        std::vector<Growing> next;
        std::size_t n = 0;
        for (std::size_t i = 0; i < cells_.size(); ++i) {
            if (n == chosen.size() || chosen[n] != i) {
                next.push_back(cells_[i]);
                continue;
            }
            for (std::size_t side = 0; side < 2; ++side)
                if (halves[n].kept[side]) next.push_back(halves[n].cells[side]);
            ++n;
        }
        cells_ = std::move(next);
    }

    /// One cell, all of it, for the lights that keep nearly all anyway.
    void give_up_idle_lights() {
        std::vector<double> kept(lights_.size(), 0.0);
        for (const Growing& cell : cells_)
            kept[cell.cell.light] += cell.cell.box.volume();
        std::vector<Growing> next;
        std::vector<bool> seen(lights_.size(), false);
        for (Growing& cell : cells_) {
            const std::uint32_t light = cell.cell.light;
            if (kept[light] > all_but_kept) {
                if (seen[light]) continue;
                seen[light] = true;
                cell.cell.box = {};
                cell.finished = true;
            }
            next.push_back(cell);
        }
        cells_ = std::move(next);
    }

    const Scene& scene_;
    ProjectionTargets targets_;
    const std::vector<OfLight>& lights_;
    std::size_t most_cells_;
    std::vector<std::uint32_t> except_;  ///< by light: its own shape, if it cannot see that
    std::vector<Growing> cells_;
};

ProjectionMap::ProjectionMap(const Scene& scene, TargetSurfaces surfaces, std::size_t most_cells) {
    for (const Light& light : scene.lights())
        lights_.push_back({power_of(light).mean()});
    cells_ = Refinement(scene, surfaces, lights_, most_cells).run();
    for (const Cell& cell : cells_)
        lights_[cell.light].kept += cell.box.volume();
    for (const OfLight& light : lights_)
        aims_ |= light.power > 0 && light.kept < 1;
    if (!cells_.empty()) prepare_choice();
}

void ProjectionMap::prepare_choice() {
    double power = 0, shining = 0;
    for (const OfLight& light : lights_) {
        power += light.power * light.kept;
        shining += light.kept > 0;
    }
    std::vector<double> choice;
    for (OfLight& light : lights_) {
        choice.push_back(
            light.kept > 0 ? (1 - uniform_share) * light.power * light.kept / power + uniform_share / shining : 0.0);
        if (light.kept > 0) light.scale = static_cast<float>(light.kept / choice.back());
    }
    double sum = 0;
    for (const Cell& cell : cells_) {
        begin_.push_back(sum);
        sum += choice[cell.light] * cell.box.volume() / lights_[cell.light].kept;
    }
    const std::size_t n = cells_.size();
    guide_.resize(n);
    for (std::size_t i = 0, cell = 0; i < n; ++i) {
        while (cell + 1 < n && begin_[cell + 1] * static_cast<double>(n) <= static_cast<double>(i))
            ++cell;
        guide_[i] = static_cast<std::uint32_t>(cell);
    }
}

std::uint32_t ProjectionMap::choose_cell(const Vec2& u_choice) const {
    // 48 bits: a cell's share may be as small as a float's last digit.
    const double u = static_cast<double>(u_choice.x()) + 0x1p-24 * static_cast<double>(u_choice.y());
    std::uint32_t i = guide_[static_cast<std::size_t>(u * static_cast<double>(guide_.size()))];
    while (i + 1 < begin_.size() && begin_[i + 1] <= u)
        ++i;
    return i;
}

EmissionSample ProjectionMap::sample_emission(const Scene& scene, std::uint32_t cell, const Vec2& u_position,
                                              const Vec2& u_direction) const {
    const auto& [box, light] = cells_[cell];
    EmissionSample sample = gib::sample_emission(
        scene.lights()[light], scene.shapes(), Vec2(within(box, 0, u_position.x()), within(box, 1, u_position.y())),
        Vec2(within(box, 2, u_direction.x()), within(box, 3, u_direction.y())));
    sample.power *= double{lights_[light].scale};
    return sample;
}

}  // namespace gib
