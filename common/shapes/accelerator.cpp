#include "common/shapes/accelerator.h"

#include "common/core/error.h"
#include "common/core/float_traps.h"
#include "common/core/memory_limit.h"
#include "common/shapes/few_spheres.h"

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

/// A tree of up to this many primitives is built by one thread, so that it cannot depend on the number of threads.
/// The tree decides which of two triangles at exactly the same distance is hit. Larger trees are built in parallel.
constexpr std::size_t serial_build_limit = 200'000;

/// Above this many primitives packets do not pay, because rays of neighbouring pixels hit different primitives and
/// soon take different ways through the tree. The path tracer's rate as a fraction of bare Embree's, with and without
/// packets: 0.58 and 0.55 on 70 thousand triangles, equal on 900 thousand, 0.66 and 0.69 on 10 million.
constexpr std::size_t packet_limit = 500'000;

/// Embree takes a triangle's determinant (edge x edge . direction) for zero if it is below 1e-18. It then answers
/// u = v = 0, although the hit may lie anywhere in the triangle's plane. In scenes larger than 1e12, its squares
/// leave the range of floats. A scene whose extent lies between these two constants is given to Embree as it is; the
/// determinant is then large enough for triangles down to 1e-9 of the scene. All other scenes are multiplied by a
/// power of two. Rays are multiplied by the same factor, origin and direction, so that t, u and v do not change.
constexpr float smallest_extent = 0.25f, largest_extent = 0x1p30f;
constexpr int scaled_exponent = 10;

/// The power of two by which coordinates within these bounds are multiplied before Embree gets them.
float embree_scale(const Bounds& bounds) {
    const float extent = bounds.empty() ? 0.f : (bounds.upper - bounds.lower).maxCoeff();
    if (!(extent > 0.f && std::isfinite(extent))) return 1.f;
    if (extent >= smallest_extent && extent <= largest_extent) return 1.f;
    return std::ldexp(1.f, std::min(scaled_exponent - std::ilogb(extent), 126));
}

Ray scaled(const Ray& ray, float scale) {
    return {.o = scale * ray.o, .d = scale * ray.d, .t_min = ray.t_min, .t_max = ray.t_max};
}

/// The data that the callbacks of one user geometry read.
struct AnalyticShape {
    const Shape* shape;
    std::uint32_t id;
    float scale;  ///< factor from the shape's coordinates to those that Embree has
};

std::optional<float> intersect_analytic(const Shape& shape, const Ray& ray) {
    if (const auto* sphere = std::get_if<Sphere>(&shape)) return intersect(*sphere, ray);
    if (const auto* disk = std::get_if<Disk>(&shape)) return intersect(*disk, ray);
    return intersect(std::get<Cylinder>(shape), ray);
}

/// The ray, multiplied by `scale`.
Ray ray_of(const RTCRay& r, float scale) {
    return {.o = Vec3(scale * r.org_x, scale * r.org_y, scale * r.org_z),
            .d = Vec3(scale * r.dir_x, scale * r.dir_y, scale * r.dir_z),
            .t_min = r.tnear,
            .t_max = r.tfar};
}

/// Writes the ray, multiplied by `scale`, to `r`. Most scales are 1, but a branch for them would not pay. Embree
/// reads four numbers at a time, and the processor would have to wait if these had been written one by one.
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
    // Hits are computed in double. The box is enlarged so that it contains them after rounding to float.
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

/// The memory per primitive that Embree takes while it builds [bytes]; Embree keeps most of it. For a mesh of 4.5
/// million triangles, 76 were measured.
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

/// Calls body(ray, i) for each ray of a packet that a callback is asked about. A packet may hold a single ray. `ray`
/// is in the coordinates before the multiplication by `scale`.
template <typename Body>
void for_each_valid(const int* valid, RTCRayN* rays, unsigned n, float scale, const Body& body) {
    const FloatTrapsResumed resumed;
    const float back = 1.f / scale;  // exact, as the scale is a power of two
    for (unsigned i = 0; i < n; ++i)
        if (valid[i]) body(ray_of(rtcGetRayFromRayN(rays, n, i), back), i);
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

/// The data that the callbacks of the instances read. All instances are primitives of one user geometry, whose
/// callbacks query the tree of the instance's group. Embree's own instances invert the map in float. The error of
/// this inverse grows with the map's condition number, which leaves no useful bound for the start of a ray. One
/// geometry per instance would also take more memory than the map.
struct InstanceSet {
    std::span<const Instance> instances;
    float scale = 1.f;  ///< embree_scale() of the scene
    struct Group {
        RTCScene scene;
        Bounds bounds;
        std::uint32_t first_shape;
        float scale;  ///< embree_scale() of the group
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
    std::vector<std::vector<std::array<float, 3>>> scaled_vertices;  ///< vertices of meshes multiplied for Embree
    InstanceSet instanced;
    FewSpheres spheres;  ///< of the scene outside all groups, if Embree has none of them
    /// The box of all that Embree has, if that is meshes alone and spheres lie outside of it. Many rays then lead away
    /// from it, as from a floor with spheres above: `path` takes 14 % less time on scenes/glass-sphere.xml.
    std::optional<Bounds> meshes;
    float scale = 1.f;    ///< embree_scale() of the scene
    bool packets = true;  ///< whether packets pay, see packet_limit

    ~State() {
        if (scene) rtcReleaseScene(scene);
        for (const auto& group : instanced.groups)
            rtcReleaseScene(group.scene);
        if (device) rtcReleaseDevice(device);
    }
    /// Whether the ray starts outside of `meshes` and leads away from them.
    bool leaves_meshes(const Ray& ray) const {
        if (!meshes) return false;
        bool leaves = false;  // without branches, which could not be predicted
        for (int k = 0; k < 3; ++k)
            leaves |= ((ray.o[k] > meshes->upper[k]) & (ray.d[k] >= 0.f)) |
                      ((ray.o[k] < meshes->lower[k]) & (ray.d[k] <= 0.f));
        return leaves;
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
    // In robust mode, a ray through a shared edge or vertex hits one of the triangles, so that a closed mesh
    // has no gaps.
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
    const auto is_sphere = [](const Shape& shape) { return std::holds_alternative<Sphere>(shape); };
    const auto found = std::count_if(shapes.begin() + begin, shapes.begin() + end, is_sphere);
    const bool few = to == scene && static_cast<std::size_t>(found) <= FewSpheres::most;
    for (std::uint32_t i = begin; i < end; ++i) {
        const auto* mesh = std::get_if<Mesh>(&shapes[i]);
        if (few && is_sphere(shapes[i])) spheres.add(std::get<Sphere>(shapes[i]), i);
        else if (mesh) attach(to, *mesh, i - begin, shapes_scale);
        else attach(to, analytic.emplace_back(AnalyticShape{&shapes[i], i - begin, shapes_scale}));
        primitives += mesh ? mesh->triangles.size() : 1;
    }
    return primitives;
}

void Accelerator::State::add_group(const std::vector<Shape>& shapes, std::uint32_t begin, std::uint32_t end) {
    auto& group = instanced.groups.emplace_back(
        InstanceSet::Group{.scene = new_scene(), .bounds = Bounds(), .first_shape = begin, .scale = 1.f});
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
    s.analytic.reserve(shapes.size());  // Embree keeps addresses of these and of the vertices below
    s.scaled_vertices.reserve(shapes.size());
    s.instanced.instances = groups.instances;
    for (std::size_t g = 0; g + 1 < groups.begin.size(); ++g)
        s.add_group(shapes, groups.begin[g], groups.begin[g + 1]);
    const auto top_shapes = groups.begin.empty() ? static_cast<std::uint32_t>(shapes.size()) : groups.begin[0];
    Bounds bounds, meshes;
    for (std::uint32_t i = 0; i < top_shapes; ++i) {
        const Bounds of_shape = bounds_of(shapes[i]);
        bounds.add(of_shape);
        if (std::holds_alternative<Mesh>(shapes[i])) meshes.add(of_shape);
    }
    for (const Instance& instance : groups.instances)
        bounds.add(transformed(instance, s.instanced.groups[instance.group].bounds));
    s.scale = s.instanced.scale = embree_scale(bounds);
    const std::size_t primitives = s.attach(s.scene, shapes, 0, top_shapes, s.scale) + groups.instances.size();
    if (!groups.instances.empty()) s.attach_instances(top_shapes);
    const bool stick_out =
        (meshes.lower.array() > bounds.lower.array() || meshes.upper.array() < bounds.upper.array()).any();
    if (stick_out && s.analytic.empty() && groups.instances.empty()) s.meshes = meshes;
    commit(s.scene, primitives);
    s.packets = primitives <= packet_limit;
    if (rtcGetDeviceError(state_->device) != RTC_ERROR_NONE) throw RunError("Embree could not build the scene's tree");
}

Accelerator::~Accelerator() = default;

void Accelerator::intersect(const Ray& ray, std::optional<Intersection>& found) const {
    float t_max = ray.t_max;
    const std::uint32_t sphere = state_->spheres.empty() ? FewSpheres::none : state_->spheres.intersect(ray, t_max);
    found.reset();
    if (!state_->leaves_meshes(ray)) {
        RTCRayHit rayhit;
        set_ray(rayhit.ray, ray, state_->scale);
        rayhit.ray.tfar = t_max;
        query(state_->scene, rayhit);
        const RTCHit& hit = rayhit.hit;
        if (hit.geomID != RTC_INVALID_GEOMETRY_ID) {
            found = intersection_of(hit.geomID, hit.primID, hit.instID[0], hit.u, hit.v, rayhit.ray.tfar);
            return;
        }
    }
    if (sphere != FewSpheres::none) found = intersection_of(sphere, 0, no_instance, 0, 0, t_max);
}

void Accelerator::intersect(std::span<const Ray> rays, std::span<std::optional<Intersection>> found) const {
    if (!state_->packets || rays.size() == 1) {
        for (std::size_t i = 0; i < rays.size(); ++i)
            intersect(rays[i], found[i]);
        return;
    }
    alignas(32) std::array<int, packet_size> valid;
    RTCRayHit8 packet;
    std::array<std::uint32_t, packet_size> spheres;
    for (std::size_t i = 0; i < packet_size; ++i) {
        valid[i] = i < rays.size() ? -1 : 0;
        const Ray& unscaled = rays[std::min(i, rays.size() - 1)];
        packet.ray.tfar[i] = unscaled.t_max;
        spheres[i] = state_->spheres.intersect(unscaled, packet.ray.tfar[i]);
        const Ray ray = scaled(unscaled, state_->scale);
        packet.ray.org_x[i] = ray.o.x();
        packet.ray.org_y[i] = ray.o.y();
        packet.ray.org_z[i] = ray.o.z();
        packet.ray.tnear[i] = ray.t_min;
        packet.ray.dir_x[i] = ray.d.x();
        packet.ray.dir_y[i] = ray.d.y();
        packet.ray.dir_z[i] = ray.d.z();
        packet.ray.time[i] = 0.f;
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
        else if (spheres[i] != FewSpheres::none)
            found[i] = intersection_of(spheres[i], 0, no_instance, 0, 0, packet.ray.tfar[i]);
    }
}

Intersection Accelerator::intersection_of(std::uint32_t geometry, std::uint32_t primitive, std::uint32_t instance,
                                          float u, float v, float t) const {
    static_assert(no_instance == RTC_INVALID_GEOMETRY_ID);
    if (instance != no_instance) geometry += state_->instanced.group_of(instance).first_shape;
    return {.shape = geometry, .primitive = primitive, .instance = instance, .u = u, .t = t, .v = v};
}

bool Accelerator::occluded(const Ray& ray) const {
    if (!state_->spheres.empty() && state_->spheres.occluded(ray)) return true;
    if (state_->leaves_meshes(ray)) return false;
    RTCRay occluded;
    set_ray(occluded, ray, state_->scale);
    query(state_->scene, occluded);
    return occluded.tfar < 0.f;
}

void* Accelerator::native_handle() const { return state_->scene; }

}  // namespace gib
