#include "methods/vcm/light_vertex_map.h"

#include "methods/parts/density/surface_disc.h"
#include "methods/parts/kd_tree/kd_tree_build.h"
#include "methods/parts/photons/blocks_within_memory.h"

namespace gib {

namespace {

constexpr std::uint64_t merged_walks = 3;  ///< keeps these walks apart from those that are connected
constexpr std::size_t walks_per_block = 1024;
/// While the tree is built there are two copies of a vertex and its 13 bytes of the tree.
constexpr double bytes_per_vertex = 2 * sizeof(LightVertex) + 13;

/// How the bias is estimated: as `factor` times the difference to the estimate from the same vertices within `narrow` times the
/// radius. A bias of order p falls by the share 1 - narrow^p between the two.
///
/// On surfaces, vertices are merged in caustics (with techniques=photon_mapping everywhere: the bias is then stated a tenth too large
/// where light is smooth). There p is 2 where light is smooth, and 1 at the edges of caustics and at rims
/// that cut the disc: with kernel.h's 2 and r / sqrt(2), the stated bias was 0.25 to 0.64 of the measured one in mean square.
/// An order of 3/2 states 0.68 (p = 1) to 1.21 (p = 2) of it; measured were 0.7 to 1.14 (README.md). A smaller disc would err
/// less and be noisier: that of r / 4 has twice the variance.
struct BiasRule {
    float narrow;
    double factor;
};
constexpr BiasRule bias_on_surfaces{1.f / 3, 1.2383};  // 1 / (1 - 3^(-3/2))
constexpr BiasRule bias_in_media{narrow_radius, double{bias_of_difference}};

struct Block {
    std::vector<LightVertex> vertices;
    std::uint64_t rays = 0;
};

/// The power of a vertex as merging needs it. The camera's walk decides for itself whether it meets a surface with
/// holes, so the share of light paths that pass by is given back. In a medium both walks have taken the scattering
/// coefficient in.
Color merged_power(const PathVertex& vertex) {
    if (vertex.hit) return vertex.beta / (1.f - vertex.hit->bsdf->pass_through());
    const Color sigma_s = vertex.medium->scattering_at(vertex.p);
    return (sigma_s > 0.f).select(vertex.beta / sigma_s, 0.f);
}

/// One merge: sums the light of a vertex's neighbours.
class Merge {
public:
    Merge(const PathVertex& eye, const PathRules& rules, const MergeRadii& radii, Kernel kernel, double power,
          BiasedSample& sample)
        : eye_(eye),
          kernel_(kernel),
          radius_(static_cast<float>(eye.hit ? radii.on_surfaces : radii.radius_at(*eye.medium, eye.p))),
          power_(power),
          samples_of_connection_(eye.is_first ? rules.first_samples() : 1),
          path_{rules.max_edges - eye.edges, eye.stratum},
          sample_(sample),
          normal_(eye.hit ? normal_towards(*eye.hit, eye.from) : Vec3::Zero()),
          transmits_(eye.hit && eye.hit->bsdf->traits().transmission) {}

    /// Bounds the radius, which is the largest of all places at first, by that of the vertex, which is that of its n. Returns
    /// whether the disc has to be cut where its surface ends: only that of a small body, because the rays cost more than they
    /// bring at the rims of large surfaces.
    bool bound_radius(const MergeRadii& radii, double n) {
        n2_ = squared(n);
        if (!eye_.hit) return true;
        const double share = radii.radius_of(n) / radii.on_surfaces;
        if (share > 0.75) return false;  // it is 1 there, or a half at most
        radius_ *= static_cast<float>(share);
        return true;
    }
    /// Whether there is anything to merge within the radius, as far as is known without rays.
    bool finds_any(const KdTree<LightVertex>& vertices) const {
        return radius_ > 0.f && vertices.any_within(eye_.p, radius_, [&](const LightVertex& light, float distance2) {
            return accepts(light, distance2);
        });
    }
    float radius() const { return radius_; }

    /// Whether the vertex may be merged, as far as is known without rays.
    bool accepts(const LightVertex& light, float distance2) const {
        return light.on_surface == eye_.hit.has_value() && path_.accepts(light) &&
               (!eye_.hit || lies_on_surface(light, distance2));
    }

    /// Finds the part of the disc that lies on the surface, or of the ball that is in sight.
    void look_around(RayQueries& rays, NumberStream& u) {
        const float narrow = narrow_of_radius();
        if (!eye_.hit) {
            share_ = 1.f / reciprocal_share_in_sight(kernel_, rays, eye_.p, radius_, u);
            narrow_share_ = 1.f / reciprocal_share_in_sight(kernel_, rays, eye_.p, narrow, u);
            return;
        }
        const float first = u.next();
        disc_.emplace(*eye_.hit, normal_, Vec2(first, u.next()));
        disc_->find_layers(rays, max_elevation_slope * radius_);
        disc_->find_obstacles(rays, radius_, radius_);
        share_ = disc_->share(kernel_, radius_) * disc_->covered(rays, kernel_, radius_);
        narrow_share_ = disc_->share(kernel_, narrow) * disc_->covered(rays, kernel_, narrow);
    }

    void add(const LightVertex& light, float distance2) {
        if (!accepts(light, distance2) || (disc_ && !disc_->contains(light.p - eye_.p))) return;
        const Vec3 w = light.direction();
        Vec3 w_local;
        LobeValues f;
        DirectionPdfs pdf;
        if (eye_.hit) {
            const SurfaceHit& hit = *eye_.hit;
            if (!hit.normals_agree_about(w)) return;
            w_local = hit.shading.to_local(w);
            if (!transmits_) w_local = lifted_above_horizon(eye_.from_local, w_local);
            f = hit.bsdf->f_local(eye_.from_local, w_local, Transport::radiance);
            const float factor = shading_normal_factor(hit, w);
            f = {f.diffuse * factor, f.specular * factor};
            pdf = direction_pdfs(eye_, eye_.from_local, w_local);
        } else {
            const float phase = eye_.medium->phase().value(eye_.from, w);
            f = {.diffuse = Color::Constant(phase)};
            pdf = {double{phase}, double{phase}};
        }
        add_weighted(light, f, kernel(distance2, radius_) / double{share_}, narrow_kernel(distance2),
                     weight(light, pdf));
    }

private:
    /// As in the density estimate of photon mapping without rays (DiscArea::rejected).
    bool lies_on_surface(const LightVertex& light, float distance2) const {
        const float cosine = light.surface_normal().dot(normal_);
        return (transmits_ ? std::abs(cosine) : cosine) > min_normal_cosine &&
               sqr((light.p - eye_.p).dot(normal_)) <= sqr(max_elevation_slope) * distance2;
    }
    const BiasRule& bias_rule() const { return eye_.hit ? bias_on_surfaces : bias_in_media; }
    float narrow_of_radius() const { return bias_rule().narrow * radius_; }
    double kernel(float distance2, float r) const {
        return eye_.hit ? kernel_weight(kernel_, distance2, r) : ball_kernel_weight(kernel_, distance2, r);
    }
    double narrow_kernel(float distance2) const {
        const float r = narrow_of_radius();
        return distance2 < sqr(r) ? kernel(distance2, r) / double{narrow_share_} : 0;
    }
    double weight(const LightVertex& light, const DirectionPdfs& pdf) const {
        const double d_vcm = (light.has_first_samples ? squared(samples_of_connection_) : 1) * light.d_vcm;
        const double others = eye_.sums.besides_both(pdf.to_camera) +      // (39) times n^2
                              d_vcm + light.d_vc * squared(pdf.to_light);  // (38) times n^2
        return 1 / (1 + others / n2_);                                     // (37)
    }
    void add_weighted(const LightVertex& light, const LobeValues& f, double density, double narrow, double weight) {
        const Colord arriving = weight * power_ * light.power().cast<double>() * path_.weight(light).cast<double>();
        const Color value = (density * arriving).cast<float>() * eye_.beta;
        const Color bias = (bias_rule().factor * (density - narrow) * arriving).cast<float>() * eye_.beta;
        const auto add_class = [&](const Color& lobe, LobeKind kind) {
            if (is_black(lobe)) return;
            const Component c = eye_.ending_with(kind).followed_by(light.path_class).component();
            sample_.light[c] += lobe * value;
            sample_.bias[c] += lobe * bias;
        };
        add_class(f.diffuse, LobeKind::diffuse);
        add_class(f.specular, LobeKind::specular);
    }

    const PathVertex& eye_;
    Kernel kernel_;
    float radius_;
    double power_;
    double n2_ = 0;
    double samples_of_connection_;  ///< with the vertex before the light's
    EyePath path_;
    BiasedSample& sample_;
    Vec3 normal_;
    bool transmits_;
    std::optional<SurfaceDisc> disc_ = {};    ///< empty where nothing ends or hides the disc
    float share_ = 1.f, narrow_share_ = 1.f;  ///< phi of the radius and of the narrow one
};

}  // namespace

template KdTree<LightVertex>::KdTree(const std::vector<LightVertex>& points);

LightVertex::LightVertex(const PathVertex& vertex)
    : LightVertexData{{merged_power(vertex), vertex.from,
                       vertex.hit ? normal_towards(*vertex.hit, vertex.from) : vertex.from, vertex.edges,
                       vertex.path_class.in_medium, vertex.stratum},
                      vertex.sums.d_vcm(),
                      vertex.sums.d_vc(),
                      vertex.path_class,
                      vertex.hit.has_value(),
                      vertex.has_first_samples},
      p(vertex.p) {}

CellsInReach::CellsInReach(const KdTree<LightVertex>& points, const MergeRadii& radii) {
    const auto radius = [&](const LightVertex& point) { return point.on_surface ? radii.on_surfaces : radii.in_media; };
    for (std::size_t i = 0; i < points.size(); ++i)
        edge_ = std::max(edge_, 2 * radius(points[i]));
    bits_.resize(std::bit_ceil(32 * points.size()));  // a point reaches eight cells or few more
    for (std::size_t i = 0; i < points.size(); ++i) {
        const LightVertex point = points[i];
        const double reach = radius(point) * (1 + 1e-5);  // distances are rounded to float
        const auto corner = [&](double side) {
            return cell_of((point.p.cast<double>().array() + side * reach).matrix());
        };
        const Cell low = corner(-1), high = corner(1);
        for (Cell at = low; at.x() <= high.x(); ++at.x())
            for (at.y() = low.y(); at.y() <= high.y(); ++at.y())
                for (at.z() = low.z(); at.z() <= high.z(); ++at.z())
                    bits_[bit(at)] = true;
    }
}

LightVertexMap::LightVertexMap(const Scene& scene, const LightPaths& paths, const PathRules& rules,
                               const MergeRule& rule, std::uint64_t seed, std::uint64_t& rays)
    : power_of_path_(paths.power / rule.radii.light_paths) {
    PathRules limited = rules;  // PhotonPayload::edges has 16 bits
    limited.max_edges = std::min(rules.max_edges, static_cast<int>(std::numeric_limits<std::uint16_t>::max()));
    const std::uint64_t key = combine_keys(seed, merged_walks);
    auto blocks = blocks_within_memory(
        static_cast<std::size_t>(rule.radii.light_paths), walks_per_block, &Block::vertices, bytes_per_vertex,
        "the light paths of a pass", [&](Block& block, std::size_t begin, std::size_t end) {
            RayQueries queries(scene);
            for (std::size_t i = begin; i < end; ++i) {
                const Sampler sampler(PointSet::independent, key, i, 0);
                const auto start = paths.emission.sample(sampler);
                if (!start) continue;
                LightWalk(queries, sampler, paths, limited, rule, *start,
                          [&](const PathVertex& vertex, const VertexNumbers&, NumberStream&) {
                              if (vertex.sums.from_both() > 0) block.vertices.emplace_back(vertex);
                          })
                    .follow();
            }
            block.rays = queries.count();
        });
    for (const Block& block : blocks)
        rays += block.rays;
    vertices_ = KdTree<LightVertex>(joined(blocks, &Block::vertices));
    cells_ = CellsInReach(vertices_, rule.radii);
}

void LightVertexMap::merge(const PathVertex& eye, MergeRule::AlongCamera& along, const PathRules& rules,
                           const MergeRadii& radii, Kernel kernel, RayQueries& rays, NumberStream& u,
                           BiasedSample& sample) const {
    if (vertices_.size() == 0 || !cells_.any_within(eye.p)) return;
    Merge merge(eye, rules, radii, kernel, power_of_path_, sample);
    if (!merge.finds_any(vertices_)) return;
    if (merge.bound_radius(radii, along.n_at(rays, eye))) {
        if (!merge.finds_any(vertices_)) return;
        merge.look_around(rays, u);
    }
    vertices_.within(eye.p, merge.radius(),
                     [&](const LightVertex& light, float distance2) { merge.add(light, distance2); });
}

}  // namespace gib
