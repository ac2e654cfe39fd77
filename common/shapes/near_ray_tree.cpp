#include "common/shapes/near_ray_tree.h"

#include "common/core/error.h"
#include "common/core/float_traps.h"
#include "common/core/memory_limit.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace gib {

namespace {

/// The memory for each item that Embree takes while it builds [bytes].
constexpr double bytes_per_item = 200;
/// Embree ignores hits of discs and curves within two radii of a ray's start, so rays begin earlier by this many.
constexpr float radii_before = 4.f;

#if RTC_VERSION_MAJOR >= 4
using QueryContext = RTCRayQueryContext;
#else
using QueryContext = RTCIntersectContext;
#endif

/// A query with the items that it has found. Embree hands the first member to the filter.
struct NearQuery {
    QueryContext context;
    std::vector<std::uint32_t>* found;
};

/// Notes each hit and rejects it, so that the search goes on.
void note_hits(const RTCFilterFunctionNArguments* args) {
    auto* query = reinterpret_cast<NearQuery*>(args->context);
    for (unsigned i = 0; i < args->N; ++i)
        if (args->valid[i]) {
            query->found->push_back(RTCHitN_primID(args->hit, args->N, i));
            args->valid[i] = 0;
        }
}

/// The number of pieces of each segment: Embree's boxes around long segments of all directions overlap so much that a
/// ray enters most of them. Pieces have about the same length. More of them make queries faster (by a third with ten times as
/// many, 80,000 beams in fog.xml), but the build slower.
constexpr double pieces_per_item = 2;

std::vector<std::uint32_t> pieces_of(std::span<const Vec3> ends) {
    std::vector<double> lengths;
    for (std::size_t i = 0; i + 1 < ends.size(); i += 2)
        lengths.push_back(double{(ends[i + 1] - ends[i]).norm()});
    const double total = std::reduce(lengths.begin(), lengths.end());
    const double longest = total / (pieces_per_item * static_cast<double>(lengths.size()));
    std::vector<std::uint32_t> pieces;
    for (const double length : lengths)
        pieces.push_back(length > longest ? static_cast<std::uint32_t>(std::ceil(length / longest)) : 1u);
    return pieces;
}

void find_all(RTCScene scene, RTCRay& ray, std::vector<std::uint32_t>& found) {
    const FloatTrapsPaused paused;
    NearQuery query{};
    query.found = &found;
#if RTC_VERSION_MAJOR >= 4
    rtcInitRayQueryContext(&query.context);
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = &query.context;
    rtcOccluded1(scene, &ray, &arguments);
#else
    rtcInitIntersectContext(&query.context);
    rtcOccluded1(scene, &query.context, &ray);
#endif
}

}  // namespace

struct NearRayTree::State {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    float scale = 1.f;  ///< factor from scene units to Embree's, in which the extent is about 1
    Vec3 centre;        ///< the origin of Embree's coordinates
    float reach;        ///< from the centre to beyond all items [scene units]
    /// The item of each piece that a segment is cut into; empty for points.
    std::vector<std::uint32_t> item_of_piece;
    float radius;  ///< in Embree's units, with a margin for rounding

    ~State() {
        if (scene) rtcReleaseScene(scene);
        if (device) rtcReleaseDevice(device);
    }
};

NearRayTree::NearRayTree() = default;
NearRayTree::~NearRayTree() = default;
NearRayTree::NearRayTree(NearRayTree&&) noexcept = default;
NearRayTree& NearRayTree::operator=(NearRayTree&&) noexcept = default;

NearRayTree::NearRayTree(std::span<const Vec3> items, std::size_t ends, float radius) {
    if (items.empty() || !(radius > 0.f)) return;
    const std::size_t count = items.size() / ends;
    require_memory(bytes_per_item * static_cast<double>(count), "the tree of photons that rays pass");
    state_ = std::make_unique<State>();
    State& s = *state_;
    Bounds bounds;
    for (const Vec3& p : items)
        bounds.add(p);
    s.centre = 0.5f * (bounds.lower + bounds.upper);
    const float extent = (bounds.upper - bounds.lower).maxCoeff() + radius;
    s.scale = std::ldexp(1.f, -std::ilogb(extent));
    s.reach = 0.5f * (bounds.upper - bounds.lower).norm() + 2.f * radius;
    // Embree computes distances from a ray in float; the margin covers their rounding.
    constexpr float share = 1e-3f;
    s.radius = s.scale * radius * (1.f + share) + 64.f * unit_roundoff;

    s.device = rtcNewDevice(nullptr);
    if (!s.device) throw RunError("Embree could not create a device");
    s.scene = rtcNewScene(s.device);
    RTCGeometry g =
        rtcNewGeometry(s.device, ends == 1 ? RTC_GEOMETRY_TYPE_DISC_POINT : RTC_GEOMETRY_TYPE_FLAT_LINEAR_CURVE);
    const auto pieces = ends == 1 ? std::vector<std::uint32_t>() : pieces_of(items);
    const std::size_t piece_count = std::reduce(pieces.begin(), pieces.end(), std::size_t{0});
    s.item_of_piece.reserve(piece_count);
    const auto new_buffer = [&](RTCBufferType type, RTCFormat format, std::size_t size, std::size_t n) {
        return rtcSetNewGeometryBuffer(g, type, 0, format, size, n);
    };
    auto* vertex = static_cast<std::array<float, 4>*>(
        new_buffer(RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, sizeof(std::array<float, 4>), piece_count + count));
    auto* first = ends == 1 ? nullptr
                            : static_cast<std::uint32_t*>(new_buffer(RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT,
                                                                     sizeof(std::uint32_t), piece_count));
    std::uint32_t vertices = 0;
    const auto add = [&](const Vec3& p) {
        const Vec3 q = s.scale * (p - s.centre);
        vertex[vertices++] = {q.x(), q.y(), q.z(), s.radius};
    };
    for (std::size_t i = 0; i < count; ++i) {
        add(items[ends * i]);
        for (std::uint32_t piece = 1; ends == 2 && piece <= pieces[i]; ++piece) {
            *first++ = vertices - 1;
            s.item_of_piece.push_back(static_cast<std::uint32_t>(i));
            const float at = static_cast<float>(piece) / static_cast<float>(pieces[i]);
            add((1.f - at) * items[2 * i] + at * items[2 * i + 1]);
        }
    }
    rtcSetGeometryOccludedFilterFunction(g, note_hits);
    rtcCommitGeometry(g);
    rtcAttachGeometry(s.scene, g);
    rtcReleaseGeometry(g);
    const FloatTrapsPaused paused;
    rtcSetSceneFlags(s.scene, RTC_SCENE_FLAG_ROBUST);
    rtcJoinCommitScene(s.scene);
    if (rtcGetDeviceError(s.device) != RTC_ERROR_NONE) throw RunError("Embree could not build the tree of photons");
}

void NearRayTree::find(const Ray& ray, std::vector<std::uint32_t>& found) const {
    found.clear();
    if (!state_) return;
    // Only the stretch near the items is searched, as distances from a ray that starts far away would be rounded coarsely.
    const float nearest = (state_->centre - ray.o).dot(ray.d);
    const float begin = std::max(ray.t_min, nearest - state_->reach),
                end = std::min(ray.t_max, nearest + state_->reach);
    if (!(begin < end)) return;
    const float before = radii_before * state_->radius;
    const Vec3 start = state_->scale * (ray.o + begin * ray.d - state_->centre) - before * ray.d;
    RTCRay r{};
    r.org_x = start.x();
    r.org_y = start.y();
    r.org_z = start.z();
    r.dir_x = ray.d.x();
    r.dir_y = ray.d.y();
    r.dir_z = ray.d.z();
    r.tnear = 0.f;
    r.tfar = state_->scale * (end - begin) + 2.f * before;
    r.mask = ~0u;
    find_all(state_->scene, r, found);
    if (!state_->item_of_piece.empty())
        for (std::uint32_t& piece : found)
            piece = state_->item_of_piece[piece];
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
}

}  // namespace gib
