#include "methods/parts/guiding/importons.h"

#include "common/core/parallel.h"
#include "methods/parts/transport/path_tracer.h"
#include "methods/parts/transport/pixel_samples.h"

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

constexpr std::uint64_t blur_tag = 0x626c7572;
constexpr float cells_across = 64;

/// A class of directions for trace_path_in(), which chooses them as path tracing does.
class ImportonDirections : public BsdfDirections {
public:
    ImportonDirections(RadianceField* field, ImportonPlaces& places) : field_(field), places_(places) {}

    void start(const Sampler& sampler) {
        blur_.emplace(sampler.split(0, 1, blur_tag));
        scattered_ = 0;
    }
    void arrive(const Vec3& p, const Vec3& normal) {
        p_ = p;
        normal_ = normal;
    }
    std::optional<ScatteredRay> scatter(PathWalk& walk, const SurfaceHit& hit, const Vec3& wo_local,
                                        const VertexNumbers& u, bool sees_lights) {
        const LobeTraits& lobes = hit.bsdf->traits_at(wo_local.z());
        come(walk, !hit.delta_only && lobes.diffuse, lobes.specular());
        const auto next = BsdfDirections::scatter(walk, hit, wo_local, u, sees_lights);
        if (next && next->lobe == LobeKind::diffuse) ++scattered_;
        return ends() ? std::nullopt : next;
    }
    std::optional<Vec3> scatter_in_medium(PathWalk& walk, const VertexNumbers& u, bool sees_lights) {
        come(walk, true, false);
        ++scattered_;
        if (ends()) return std::nullopt;
        return BsdfDirections::scatter_in_medium(walk, u, sees_lights);
    }

private:
    bool ends() const { return !field_ && scattered_ > 0; }
    void come(const PathWalk& walk, bool uses, bool focuses) {
        const double weight{luminance(walk.at.beta)};
        if (!std::isfinite(weight) || !(weight > 0)) return;
        if (scattered_ == 0 && uses) places_.used.push_back({p_, weight});
        if (scattered_ == 0 || !field_) return;
        places_.needed.push_back({p_, weight});
        if (focuses) places_.specular.push_back({p_, weight});
        const RadianceField::Place place = field_->place(p_, normal_);
        field_->visit(place, 0, 0);
        field_->record(place, walk.wo(), weight, blur_->at_vertex(walk.at.vertex));
    }

    RadianceField* field_;  ///< null: importons end where light is used
    ImportonPlaces& places_;
    std::optional<Sampler> blur_;
    Vec3 p_ = Vec3::Zero(), normal_ = Vec3::Zero();
    int scattered_ = 0;  ///< by diffuse lobes and media
};

}  // namespace

void ImportonPlaces::append(const ImportonPlaces& more) {
    used.insert(used.end(), more.used.begin(), more.used.end());
    needed.insert(needed.end(), more.needed.begin(), more.needed.end());
    specular.insert(specular.end(), more.specular.begin(), more.specular.end());
    rays += more.rays;
}

ImportonPlaces follow_importons(const Scene& scene, int max_edges, std::size_t count, std::uint64_t key,
                                RadianceField* field) {
    constexpr std::size_t per_block = 1024;
    std::vector<ImportonPlaces> blocks((count + per_block - 1) / per_block);
    parallel_blocks(count, per_block, [&](std::size_t begin, std::size_t end, std::size_t block) {
        ImportonPlaces& places = blocks[block];
        RayQueries rays(scene);
        ImportonDirections directions(field, places);
        for_paths_over_image(rays, key, begin, end, count, [&](const TracedRay& eye, const Sampler& sampler) {
            directions.start(sampler);
            trace_path_in(directions, rays, eye, sampler, max_edges, false);
        });
        places.rays = rays.count();
    });
    ImportonPlaces all;
    for (const ImportonPlaces& block : blocks)
        all.append(block);
    return all;
}

Cells::Cells(const Scene& scene, const std::vector<ImportonVertex>& places) : size_(scene.diagonal() / cells_across) {
    if (places.empty()) return;
    Bounds most;
    for (const double quantile : {0.05, 0.95}) {
        Vec3 at;
        for (int i = 0; i < 3; ++i) {
            std::vector<float> x;
            for (const ImportonVertex& place : places)
                x.push_back(place.p[i]);
            const auto nth = x.begin() + static_cast<std::ptrdiff_t>(quantile * static_cast<double>(x.size() - 1));
            std::nth_element(x.begin(), nth, x.end());
            at[i] = *nth;
        }
        most.add(at);
    }
    size_ = std::max(most.diagonal() / cells_across, size_ / cells_across);
}

Cells::Index Cells::of(const Vec3& p) const {
    const Vec3 x = p / size_;
    return {static_cast<int>(std::floor(x[0])), static_cast<int>(std::floor(x[1])), static_cast<int>(std::floor(x[2]))};
}

Vec3 Cells::center(const Index& cell) const {
    const Vec3 corner(static_cast<float>(cell[0]), static_cast<float>(cell[1]), static_cast<float>(cell[2]));
    return (corner + Vec3::Constant(0.5f)) * size_;
}

std::map<Cells::Index, double> Cells::weights(const std::vector<ImportonVertex>& places) const {
    std::map<Index, double> weights;
    for (const ImportonVertex& place : places)
        weights[of(place.p)] += place.weight;
    return weights;
}

}  // namespace gib
