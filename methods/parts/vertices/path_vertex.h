#pragma once
// A vertex at which a path from the camera and a path from a light can be joined.

#include "methods/parts/transport/path_walk.h"
#include "methods/parts/vertices/technique_sums.h"

#include <optional>
#include <utility>

namespace gib {

/// The densities [1/sr] with which the two walks sample the directions of one vertex: `to_light` is taken by the
/// camera's walk and `to_camera` by the light's.
struct DirectionPdfs {
    double to_light = 0, to_camera = 0;
};

/// A vertex of a walk, on a surface with lobes that are no delta, or in a medium. Directions point away from it.
struct PathVertex {
    std::optional<SurfaceHit> hit;  ///< empty in a medium
    Vec3 p;
    Vec3 from;             ///< direction towards where the walk came from, unit
    Vec3 from_local;       ///< the same in the shading frame of the hit
    const Medium* medium;  ///< medium that the walk arrived in; null: vacuum
    Color beta;            ///< throughput of the camera's walk on arrival, or the light's power [LightPaths::power]
    PathClass path_class;  ///< class of the vertices between this one and the walk's start, read from the camera
    std::optional<int> stratum;
    int edges;              ///< number of edges of the walk up to here
    bool is_first = false;  ///< of the camera's walk, the first one that can be joined
    /// True if PathRules::first_samples() count for the technique that connects the last edge of this light's walk.
    bool has_first_samples = true;
    TechniqueSums sums;

    /// A vertex where the walk has arrived, on a surface or in a medium.
    PathVertex(const PathWalk& walk, SurfaceHit&& surface, const PathClass& inner, const TechniqueSums& carried)
        : PathVertex(walk, surface.p, inner, carried) {
        hit = std::move(surface);
        from_local = hit->shading.to_local(from);
    }
    PathVertex(const PathWalk& walk, const Vec3& in_medium, const PathClass& inner, const TechniqueSums& carried)
        : p(in_medium),
          from(walk.wo()),
          from_local(from),
          medium(walk.at.medium),
          beta(walk.at.beta),
          path_class(inner),
          stratum(walk.at.stratum),
          edges(walk.at.vertex + 1),
          sums(carried) {}

    /// Whether some lobe is no delta, so that light from another walk's vertex can be scattered here.
    bool can_be_joined() const {
        if (!hit) return true;
        const LobeTraits& lobes = hit->bsdf->traits_at(from_local.z());
        return !hit->delta_only && (lobes.diffuse || lobes.glossy);
    }
    /// The class of the path if this vertex scatters by a lobe of this kind. ending_with(): the vertex ends the
    /// camera's walk; beginning_with(): it ends the light's walk. A medium has no kinds of lobes.
    PathClass ending_with(LobeKind kind) const { return hit ? path_class.after(kind) : path_in_medium(); }
    PathClass beginning_with(LobeKind kind) const { return hit ? path_class.preceded_by(kind) : path_in_medium(); }
    PathClass path_in_medium() const {
        PathClass path = path_class;
        path.in_medium = true;
        return path;
    }
    /// TechniqueSums::earlier() of a light's vertex that is the camera walk's first.
    double earlier_at_first(double reverse, double first_samples) const {
        return sums.earlier(reverse) + (has_first_samples ? squared(first_samples) - 1 : 0) * sums.d_vcm();
    }
    /// w in the shading frame of the hit; in a medium as it is.
    Vec3 to_local(const Vec3& w) const { return hit ? hit->shading.to_local(w) : w; }
    /// |cos| of w and the geometric normal; 1 in a medium.
    float cosine(const Vec3& w) const { return hit ? std::abs(w.dot(hit->ng)) : 1.f; }
    /// Whether light from w, a vector of any length, lies on a side from which the surface may scatter it.
    bool faces(const Vec3& w) const {
        return !hit || hit->bsdf->traits().transmission || w.dot(hit->shading.n) * from_local.z() > 0.f;
    }
    /// The vertex as lights light it.
    LitPoint lit(const Scene& scene) const { return hit ? scene.lit(*hit, from) : LitPoint(p); }
    /// Where a segment that leaves the vertex in direction w starts.
    Vec3 origin(const Vec3& w) const { return hit ? offset_origin(*hit, w) : p; }
    /// Where a segment that arrives from `start` ends, which is farther off the surface by the segment's own rounding.
    Vec3 target(const Vec3& start) const {
        if (!hit) return p;
        const Vec3 normal = normal_towards(*hit, start - p);
        return p + (hit->offset + rounding_of_connection(p, start)) * normal;
    }
    /// The medium in which a segment leaves in direction w.
    const Medium* medium_towards(const Scene& scene, const Vec3& w) const {
        return hit && scene.has_media() ? scene.medium_beyond(*hit, w, medium) : medium;
    }
};

/// Whether rounding hides on which side of one vertex's surface the other vertex lies; `between` leads from one to the
/// other. Two vertices of one flat face, the one on its outer and the other on its inner side, would see each other
/// through it. Light that connections within this angle carry is lost, a share of about the square of rounding over
/// distance.
inline bool are_level(const PathVertex& a, const PathVertex& b, const Vec3& between) {
    const auto offset = [](const PathVertex& at) { return at.hit ? at.hit->offset : 0.f; };
    const float rounding = offset(a) + offset(b) + rounding_of_connection(a.p, b.p);
    const auto is_level = [&](const PathVertex& at) { return at.hit && std::abs(between.dot(at.hit->ng)) <= rounding; };
    return is_level(a) || is_level(b);
}

/// The scattering at a vertex of the camera's walk of light from direction w: f |cos| of the shading normal by kind of
/// lobe [1/sr], to be multiplied by radiance. In a medium it is the phase function, as `diffuse`, because the kind is of
/// no account there. `w_local` is at.to_local(w).
inline LobeValues scattered_to_camera(const PathVertex& at, const Vec3& w, const Vec3& w_local) {
    if (!at.hit) return {.diffuse = Color::Constant(at.medium->phase().value(at.from, w))};
    const SurfaceHit& hit = *at.hit;
    if (!hit.normals_agree_about(w)) return {};
    const LobeValues f = hit.bsdf->f_local(at.from_local, w_local, Transport::radiance);
    const float cosine = std::abs(w_local.z());
    return {f.diffuse * cosine, f.specular * cosine};
}

/// The same at a vertex of a light's walk, of its light into direction w. The power that has arrived is a flux through
/// the geometric surface, so the factor is f |cos| of the shading normal over |cos| of the geometric one, both of the
/// light's direction (Veach 1997, section 5.3).
inline LobeValues scattered_from_light(const PathVertex& at, const Vec3& w, const Vec3& w_local) {
    if (!at.hit) return scattered_to_camera(at, w, w_local);
    const SurfaceHit& hit = *at.hit;
    const float arriving = std::abs(at.from.dot(hit.ng));
    if (!hit.normals_agree_about(w) || !(arriving > 0.f)) return {};
    const LobeValues f = hit.bsdf->f_local(w_local, at.from_local, Transport::radiance);
    const float factor = std::abs(at.from_local.z()) / arriving;
    return {f.diffuse * factor, f.specular * factor};
}

/// The densities of both walks at a vertex whose neighbours on the path lie in these directions, given as by
/// PathVertex::to_local().
inline DirectionPdfs direction_pdfs(const PathVertex& at, const Vec3& to_camera, const Vec3& to_light) {
    if (!at.hit) {
        const double phase{at.medium->phase().value(to_camera, to_light)};
        return {phase, phase};
    }
    const Bsdf::PairPdfs pdfs = at.hit->bsdf->pdfs_local(to_camera, to_light);
    return {double{pdfs.radiance}, double{pdfs.power}};
}

/// Scatters the walk in its medium and takes the sums past the event. Returns the direction, and TechniqueSums::scatter().
inline std::pair<Vec3, double> scatter_in_medium(PathWalk& walk, TechniqueSums& sums, const VertexNumbers& u) {
    const Vec3 from = walk.wo(), to = walk.scatter_in_medium(u, true);
    return {to, sums.scatter(double{walk.at.pdf_w}, double{walk.at.medium->phase().value(to, from)}, 1)};
}

/// Takes the sums past a surface at which the walk has been scattered in direction `next`; `other` is what the other
/// walk carries. Returns TechniqueSums::scatter(), or 0 at a delta lobe.
inline double step(TechniqueSums& sums, const PathVertex& at, const ScatteredRay& next, Transport other) {
    if (!sums.has_others()) return 0;
    const SurfaceHit& hit = *at.hit;
    const double cosine = std::abs(double{next.wi.dot(hit.ng)});
    if (next.delta) {
        sums.scatter_specularly(cosine);
        return 0;
    }
    const Vec3 to_local = hit.shading.to_local(next.wi);
    return sums.scatter(double{next.pdf_w}, double{hit.bsdf->pdf_w_local(to_local, at.from_local, Lobes::all, other)},
                        cosine);
}

}  // namespace gib
