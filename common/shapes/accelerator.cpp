#include "common/shapes/accelerator.h"

#include "common/core/error.h"
#include "common/core/float_traps.h"
#include "common/core/memory_limit.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <fmt/format.h>
#include <oneapi/tbb/task_arena.h>
#include <algorithm>
#include <array>
#include <cstring>
#include <span>

namespace gib {

namespace {

/// Up to this many primitives the tree is built by one thread, so that it, and with it the choice between triangles
/// that are hit at exactly the same distance, cannot depend on the number of threads. Larger trees are built in
/// parallel.
constexpr std::size_t serial_build_limit = 200'000;

/// Above this many primitives, rays of neighbouring pixels hit different ones, and part ways too early for packets. The
/// path tracer's rate over bare Embree's with and without them: 0.58 and 0.55 on 70 thousand triangles, alike on 900
/// thousand, 0.66 and 0.69 on 10 million.
constexpr std::size_t packet_limit = 500'000;

/// Embree takes a triangle's determinant (edge x edge . direction) below 1e-18 for zero and then answers u = v = 0, a
/// point that may lie anywhere on the triangle's plane; of scenes above 1e12 its squares leave float's range. It is
/// given scenes of an extent between these as they are, for which the determinant holds triangles down to 1e-9 of the
/// scene, and all others multiplied by a power of two. Rays are multiplied alike, origin and direction, so that t, u
/// and v are what they were.
constexpr float smallest_extent = 0.25f, largest_extent = 0x1p30f;
constexpr int scaled_exponent = 10;

/// The power of two by which Embree is given what lies within these bounds.
float embree_scale(const Bounds& bounds) {
    const float extent = bounds.empty() ? 0.f : (bounds.upper - bounds.lower).maxCoeff();
    if (!(extent > 0.f && std::isfinite(extent))) return 1.f;
    if (extent >= smallest_extent && extent <= largest_extent) return 1.f;
    return std::ldexp(1.f, std::min(scaled_exponent - std::ilogb(extent), 126));
}

Ray scaled(const Ray& ray, float scale) { return {scale * ray.o, scale * ray.d, ray.t_min, ray.t_max}; }

/// What the callbacks of one user geometry read.
struct AnalyticShape {
    const Shape* shape;
    std::uint32_t id;
    float scale;  ///< of the coordinates that Embree knows it in
};

std::optional<float> intersect_analytic(const Shape& shape, const Ray& ray) {
    if (const auto* sphere = std::get_if<Sphere>(&shape)) return intersect(*sphere, ray);
    if (const auto* disk = std::get_if<Disk>(&shape)) return intersect(*disk, ray);
    return intersect(std::get<Cylinder>(shape), ray);
}

Ray ray_of(const RTCRay& r) {
    return {Vec3(r.org_x, r.org_y, r.org_z), Vec3(r.dir_x, r.dir_y, r.dir_z), r.tnear, r.tfar};
}

/// The ray, multiplied by `scale`: without a branch, since most are multiplied by 1. Embree reads four numbers at a
/// time, and a processor makes it wait where they were written one by one.
void set_ray(RTCRay& r, const Ray& ray, float scale) {
    using Four [[gnu::vector_size(16)]] = float;
    const Four factor = {scale, scale, scale, 1.f};
    const Four origin = Four{ray.o.x(), ray.o.y(), ray.o.z(), ray.t_min} * factor,
               direction = Four{ray.d.x(), ray.d.y(), ray.d.z(), 0.f} * factor;
    std::memcpy(&r.org_x, &origin, sizeof origin);
    std::memcpy(&r.dir_x, &direction, sizeof direction);
    r.tfar = ray.t_max;
    r.mask = ~0u;
    r.id = 0;
    r.flags = 0;
}

void set_bounds(RTCBounds& bounds, const Bounds& unscaled, float scale) {
    const Bounds b{scale * unscaled.lower, scale * unscaled.upper};
    // Hits are found in double: the box must hold them after rounding to float.
    const Vec3 margin = 4.f * unit_roundoff * (b.lower.cwiseAbs() + b.upper.cwiseAbs() + (b.upper - b.lower));
    bounds.lower_x = b.lower.x() - margin.x();
    bounds.lower_y = b.lower.y() - margin.y();
    bounds.lower_z = b.lower.z() - margin.z();
    bounds.upper_x = b.upper.x() + margin.x();
    bounds.upper_y = b.upper.y() + margin.y();
    bounds.upper_z = b.upper.z() + margin.z();
}

void query(RTCScene scene, RTCRayHit& rayhit) {
    const FloatTrapsPaused paused;
    rayhit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rayhit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
    rtcIntersect1(scene, &rayhit);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, &rayhit);
#endif
}

void query(RTCScene scene, RTCRay& ray) {
    const FloatTrapsPaused paused;
#if RTC_VERSION_MAJOR >= 4
    rtcOccluded1(scene, &ray);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene, &context, &ray);
#endif
}

void query(RTCScene scene, const int* valid, RTCRayHit8& packet) {
    const FloatTrapsPaused paused;
#if RTC_VERSION_MAJOR >= 4
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    rtcIntersect8(valid, scene, &packet, &arguments);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect8(valid, scene, &context, &packet);
#endif
}

/// What Embree takes while it builds, of which it keeps the larger part: 76 were measured for a mesh of 4.5 million
/// triangles.
constexpr double bytes_per_primitive = 100;

void commit(RTCScene scene, std::size_t primitives) {
    require_memory(bytes_per_primitive * static_cast<double>(primitives),
                   fmt::format("the tree of {} triangles and other shapes", primitives));
    const auto build = [&] {
        const FloatTrapsPaused paused;
        rtcJoinCommitScene(scene);
    };
    if (primitives <= serial_build_limit) tbb::task_arena(1).execute(build);
    else build();
}

void analytic_bounds(const RTCBoundsFunctionArguments* args) {
    const auto* a = static_cast<const AnalyticShape*>(args->geometryUserPtr);
    set_bounds(*args->bounds_o, bounds_of(*a->shape), a->scale);
}

/// Calls body(ray, i) for each ray that a callback is asked about, one or some of a packet, in the scene's own
/// coordinates.
template <typename Body>
void for_each_valid(const int* valid, RTCRayN* rays, unsigned n, float scale, const Body& body) {
    const FloatTrapsResumed resumed;
    for (unsigned i = 0; i < n; ++i)
        if (valid[i]) body(scaled(ray_of(rtcGetRayFromRayN(rays, n, i)), 1.f / scale), i);
}

void analytic_intersect(const RTCIntersectFunctionNArguments* args) {
    const auto* a = static_cast<const AnalyticShape*>(args->geometryUserPtr);
    RTCRayN* rays = RTCRayHitN_RayN(args->rayhit, args->N);
    RTCHitN* hits = RTCRayHitN_HitN(args->rayhit, args->N);
    for_each_valid(args->valid, rays, args->N, a->scale, [&](const Ray& ray, unsigned i) {
        const auto t = intersect_analytic(*a->shape, ray);
        if (!t) return;
        RTCRayN_tfar(rays, args->N, i) = *t;
        RTCHitN_u(hits, args->N, i) = RTCHitN_v(hits, args->N, i) = 0;
        RTCHitN_geomID(hits, args->N, i) = a->id;
        RTCHitN_primID(hits, args->N, i) = 0;
        RTCHitN_instID(hits, args->N, i, 0) = RTC_INVALID_GEOMETRY_ID;
    });
}

void analytic_occluded(const RTCOccludedFunctionNArguments* args) {
    const auto* a = static_cast<const AnalyticShape*>(args->geometryUserPtr);
    for_each_valid(args->valid, args->ray, args->N, a->scale, [&](const Ray& ray, unsigned i) {
        if (intersect_analytic(*a->shape, ray)) RTCRayN_tfar(args->ray, args->N, i) = -infinity;
    });
}

/// What the callbacks of the instances read: all of them are the primitives of one user geometry, which asks the tree
/// of their group. Embree's own instances invert the map in float, with an error that grows with its condition; no
/// useful bound for the start of a ray is left of that. A geometry for each would also take more memory than the map.
struct InstanceSet {
    std::span<const Instance> instances;
    float scale = 1.f;  ///< of the scene that they stand in
    struct Group {
        RTCScene scene;
        Bounds bounds;
        std::uint32_t first_shape;
        float scale;  ///< of its own scene
    };
    std::vector<Group> groups;

    const Instance& at(unsigned i) const { return instances[i]; }
    const Group& group_of(unsigned i) const { return groups[at(i).group]; }
};

void instance_bounds(const RTCBoundsFunctionArguments* args) {
    const auto* set = static_cast<const InstanceSet*>(args->geometryUserPtr);
    set_bounds(*args->bounds_o, transformed(set->at(args->primID), set->group_of(args->primID).bounds), set->scale);
}

void instance_intersect(const RTCIntersectFunctionNArguments* args) {
    const auto* set = static_cast<const InstanceSet*>(args->geometryUserPtr);
    RTCRayN* rays = RTCRayHitN_RayN(args->rayhit, args->N);
    RTCHitN* hits = RTCRayHitN_HitN(args->rayhit, args->N);
    for_each_valid(args->valid, rays, args->N, set->scale, [&](const Ray& ray, unsigned i) {
        RTCRayHit in_group;
        set_ray(in_group.ray, carried_to_group(set->at(args->primID), ray), set->group_of(args->primID).scale);
        query(set->group_of(args->primID).scene, in_group);
        if (in_group.hit.geomID == RTC_INVALID_GEOMETRY_ID) return;
        in_group.hit.instID[0] = args->primID;
        RTCRayN_tfar(rays, args->N, i) = in_group.ray.tfar;
        rtcCopyHitToHitN(hits, &in_group.hit, args->N, i);
    });
}

void instance_occluded(const RTCOccludedFunctionNArguments* args) {
    const auto* set = static_cast<const InstanceSet*>(args->geometryUserPtr);
    for_each_valid(args->valid, args->ray, args->N, set->scale, [&](const Ray& ray, unsigned i) {
        RTCRay in_group;
        set_ray(in_group, carried_to_group(set->at(args->primID), ray), set->group_of(args->primID).scale);
        query(set->group_of(args->primID).scene, in_group);
        if (in_group.tfar < 0.f) RTCRayN_tfar(args->ray, args->N, i) = -infinity;
    });
}

}  // namespace

struct Accelerator::State {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    std::vector<AnalyticShape> analytic;
    std::vector<std::vector<std::array<float, 3>>> scaled_vertices;  ///< of meshes that Embree is given multiplied
    InstanceSet instanced;
    float scale = 1.f;    ///< see embree_scale()
    bool packets = true;  ///< pay: see packet_limit

    ~State() {
        if (scene) rtcReleaseScene(scene);
        for (const auto& group : instanced.groups)
            rtcReleaseScene(group.scene);
        if (device) rtcReleaseDevice(device);
    }
    RTCScene new_scene() const;
    void attach(RTCScene to, const Mesh& mesh, unsigned id, float mesh_scale);
    void attach(RTCScene to, const AnalyticShape& shape);
    void attach_instances(unsigned id);
    /// Attaches shapes [begin, end), numbered from 0, and returns how many primitives they have.
    std::size_t attach(RTCScene to, const std::vector<Shape>& shapes, std::uint32_t begin, std::uint32_t end,
                       float shapes_scale);
    void add_group(const std::vector<Shape>& shapes, std::uint32_t begin, std::uint32_t end);
};

RTCScene Accelerator::State::new_scene() const {
    RTCScene result = rtcNewScene(device);
    // Robust: rays through shared edges and vertices hit one of the triangles, so that closed meshes are closed.
    rtcSetSceneFlags(result, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(result, RTC_BUILD_QUALITY_HIGH);
    return result;
}

void Accelerator::State::attach(RTCScene to, const Mesh& mesh, unsigned id, float mesh_scale) {
    RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    const auto* vertices = &mesh.vertices;
    if (mesh_scale != 1.f) {
        auto& multiplied = scaled_vertices.emplace_back(mesh.vertices);
        for (auto& vertex : multiplied)
            for (float& x : vertex)
                x *= mesh_scale;
        vertices = &multiplied;
    }
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices->data(), 0,
                               sizeof((*vertices)[0]), vertices->size() - 1);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                               sizeof(mesh.triangles[0]), mesh.triangles.size());
    rtcCommitGeometry(g);
    rtcAttachGeometryByID(to, g, id);
    rtcReleaseGeometry(g);
}

void Accelerator::State::attach(RTCScene to, const AnalyticShape& shape) {
    RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(g, 1);
    rtcSetGeometryUserData(g, const_cast<AnalyticShape*>(&shape));
    rtcSetGeometryBoundsFunction(g, analytic_bounds, nullptr);
    rtcSetGeometryIntersectFunction(g, analytic_intersect);
    rtcSetGeometryOccludedFunction(g, analytic_occluded);
    rtcCommitGeometry(g);
    rtcAttachGeometryByID(to, g, shape.id);
    rtcReleaseGeometry(g);
}

void Accelerator::State::attach_instances(unsigned id) {
    RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(g, static_cast<unsigned>(instanced.instances.size()));
    rtcSetGeometryUserData(g, &instanced);
    rtcSetGeometryBoundsFunction(g, instance_bounds, nullptr);
    rtcSetGeometryIntersectFunction(g, instance_intersect);
    rtcSetGeometryOccludedFunction(g, instance_occluded);
    rtcCommitGeometry(g);
    rtcAttachGeometryByID(scene, g, id);
    rtcReleaseGeometry(g);
}

std::size_t Accelerator::State::attach(RTCScene to, const std::vector<Shape>& shapes, std::uint32_t begin,
                                       std::uint32_t end, float shapes_scale) {
    std::size_t primitives = 0;
    for (std::uint32_t i = begin; i < end; ++i) {
        const auto* mesh = std::get_if<Mesh>(&shapes[i]);
        if (mesh) attach(to, *mesh, i - begin, shapes_scale);
        else attach(to, analytic.emplace_back(AnalyticShape{&shapes[i], i - begin, shapes_scale}));
        primitives += mesh ? mesh->triangles.size() : 1;
    }
    return primitives;
}

void Accelerator::State::add_group(const std::vector<Shape>& shapes, std::uint32_t begin, std::uint32_t end) {
    auto& group = instanced.groups.emplace_back(InstanceSet::Group{new_scene(), Bounds(), begin, 1.f});
    for (std::uint32_t i = begin; i < end; ++i)
        group.bounds.add(bounds_of(shapes[i]));
    group.scale = embree_scale(group.bounds);
    commit(group.scene, attach(group.scene, shapes, begin, end, group.scale));
}

Accelerator::Accelerator(const std::vector<Shape>& shapes, const InstancedGroups& groups)
    : state_(std::make_unique<State>()) {
    State& s = *state_;
    s.device = rtcNewDevice(nullptr);
    if (!s.device) throw RunError("Embree could not create a device");
    s.scene = s.new_scene();
    s.analytic.reserve(shapes.size());  // Embree keeps the addresses, and those of the vertices
    s.scaled_vertices.reserve(shapes.size());
    s.instanced.instances = groups.instances;
    for (std::size_t g = 0; g + 1 < groups.begin.size(); ++g)
        s.add_group(shapes, groups.begin[g], groups.begin[g + 1]);
    const auto top_shapes = groups.begin.empty() ? static_cast<std::uint32_t>(shapes.size()) : groups.begin[0];
    Bounds bounds;
    for (std::uint32_t i = 0; i < top_shapes; ++i)
        bounds.add(bounds_of(shapes[i]));
    for (const Instance& instance : groups.instances)
        bounds.add(transformed(instance, s.instanced.groups[instance.group].bounds));
    s.scale = s.instanced.scale = embree_scale(bounds);
    const std::size_t primitives = s.attach(s.scene, shapes, 0, top_shapes, s.scale) + groups.instances.size();
    if (!groups.instances.empty()) s.attach_instances(top_shapes);
    commit(s.scene, primitives);
    s.packets = primitives <= packet_limit;
    if (rtcGetDeviceError(state_->device) != RTC_ERROR_NONE) throw RunError("Embree could not build the scene's tree");
}

Accelerator::~Accelerator() = default;

std::optional<Intersection> Accelerator::intersect(const Ray& ray) const {
    RTCRayHit rayhit;
    set_ray(rayhit.ray, ray, state_->scale);
    query(state_->scene, rayhit);
    const RTCHit& hit = rayhit.hit;
    if (hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return intersection_of(hit.geomID, hit.primID, hit.instID[0], hit.u, hit.v, rayhit.ray.tfar);
}

void Accelerator::intersect(std::span<const Ray> rays, std::span<std::optional<Intersection>> found) const {
    if (!state_->packets) {
        for (std::size_t i = 0; i < rays.size(); ++i)
            found[i] = intersect(rays[i]);
        return;
    }
    alignas(32) std::array<int, packet_size> valid;
    RTCRayHit8 packet;
    for (std::size_t i = 0; i < packet_size; ++i) {
        valid[i] = i < rays.size() ? -1 : 0;
        const Ray ray = scaled(rays[std::min(i, rays.size() - 1)], state_->scale);
        packet.ray.org_x[i] = ray.o.x();
        packet.ray.org_y[i] = ray.o.y();
        packet.ray.org_z[i] = ray.o.z();
        packet.ray.tnear[i] = ray.t_min;
        packet.ray.dir_x[i] = ray.d.x();
        packet.ray.dir_y[i] = ray.d.y();
        packet.ray.dir_z[i] = ray.d.z();
        packet.ray.time[i] = 0.f;
        packet.ray.tfar[i] = ray.t_max;
        packet.ray.mask[i] = ~0u;
        packet.ray.id[i] = 0;
        packet.ray.flags[i] = 0;
        packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
        packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    query(state_->scene, valid.data(), packet);
    const auto& hit = packet.hit;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        found[i].reset();
        if (hit.geomID[i] != RTC_INVALID_GEOMETRY_ID)
            found[i] =
                intersection_of(hit.geomID[i], hit.primID[i], hit.instID[0][i], hit.u[i], hit.v[i], packet.ray.tfar[i]);
    }
}

Intersection Accelerator::intersection_of(std::uint32_t geometry, std::uint32_t primitive, std::uint32_t instance,
                                          float u, float v, float t) const {
    static_assert(no_instance == RTC_INVALID_GEOMETRY_ID);
    if (instance != no_instance) geometry += state_->instanced.group_of(instance).first_shape;
    return {geometry, primitive, instance, u, t, v};
}

bool Accelerator::occluded(const Ray& ray) const {
    RTCRay occluded;
    set_ray(occluded, ray, state_->scale);
    query(state_->scene, occluded);
    return occluded.tfar < 0.f;
}

void* Accelerator::native_handle() const { return state_->scene; }

}  // namespace gib
