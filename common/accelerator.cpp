#include "common/accelerator.h"

#include "common/error.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <oneapi/tbb/task_arena.h>

namespace gib {

namespace {

/// Up to this many primitives the tree is built by one thread, so that it, and with it the choice between triangles
/// that are hit at exactly the same distance, cannot depend on the number of threads. Larger trees are built in
/// parallel.
constexpr std::size_t serial_build_limit = 200'000;

/// What the callbacks of one user geometry read.
struct AnalyticShape {
    const Shape* shape;
    std::uint32_t id;
};

std::optional<float> intersect_analytic(const Shape& shape, const Ray& ray) {
    if (const auto* sphere = std::get_if<Sphere>(&shape)) return intersect(*sphere, ray);
    if (const auto* disk = std::get_if<Disk>(&shape)) return intersect(*disk, ray);
    return intersect(std::get<Cylinder>(shape), ray);
}

Ray ray_of(const RTCRay& r) {
    return {Vec3(r.org_x, r.org_y, r.org_z), Vec3(r.dir_x, r.dir_y, r.dir_z), r.tnear, r.tfar};
}

void set_ray(RTCRay& r, const Ray& ray) {
    r.org_x = ray.o.x();
    r.org_y = ray.o.y();
    r.org_z = ray.o.z();
    r.tnear = ray.t_min;
    r.dir_x = ray.d.x();
    r.dir_y = ray.d.y();
    r.dir_z = ray.d.z();
    r.time = 0;
    r.tfar = ray.t_max;
    r.mask = ~0u;
    r.id = 0;
    r.flags = 0;
}

void analytic_bounds(const RTCBoundsFunctionArguments* args) {
    const auto* a = static_cast<const AnalyticShape*>(args->geometryUserPtr);
    const Bounds b = bounds_of(*a->shape);
    // Hits are found in double: the box must hold them after rounding to float.
    const Vec3 margin = 4.f * unit_roundoff * (b.lower.cwiseAbs() + b.upper.cwiseAbs() + (b.upper - b.lower));
    args->bounds_o->lower_x = b.lower.x() - margin.x();
    args->bounds_o->lower_y = b.lower.y() - margin.y();
    args->bounds_o->lower_z = b.lower.z() - margin.z();
    args->bounds_o->upper_x = b.upper.x() + margin.x();
    args->bounds_o->upper_y = b.upper.y() + margin.y();
    args->bounds_o->upper_z = b.upper.z() + margin.z();
}

void analytic_intersect(const RTCIntersectFunctionNArguments* args) {
    if (!args->valid[0]) return;
    const auto* a = static_cast<const AnalyticShape*>(args->geometryUserPtr);
    auto* rayhit = reinterpret_cast<RTCRayHit*>(args->rayhit);
    const auto t = intersect_analytic(*a->shape, ray_of(rayhit->ray));
    if (!t) return;
    rayhit->ray.tfar = *t;
    rayhit->hit.u = rayhit->hit.v = 0;
    rayhit->hit.geomID = a->id;
    rayhit->hit.primID = 0;
    rayhit->hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
}

void analytic_occluded(const RTCOccludedFunctionNArguments* args) {
    if (!args->valid[0]) return;
    const auto* a = static_cast<const AnalyticShape*>(args->geometryUserPtr);
    auto* ray = reinterpret_cast<RTCRay*>(args->ray);
    if (intersect_analytic(*a->shape, ray_of(*ray))) ray->tfar = -infinity;
}

}  // namespace

struct Accelerator::State {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    std::vector<AnalyticShape> analytic;

    ~State() {
        if (scene) rtcReleaseScene(scene);
        if (device) rtcReleaseDevice(device);
    }
    void attach(const Mesh& mesh, unsigned id);
    void attach(const AnalyticShape& shape);
};

void Accelerator::State::attach(const Mesh& mesh, unsigned id) {
    RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.vertices.data(), 0,
                               sizeof(mesh.vertices[0]), mesh.vertices.size() - 1);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                               sizeof(mesh.triangles[0]), mesh.triangles.size());
    rtcCommitGeometry(g);
    rtcAttachGeometryByID(scene, g, id);
    rtcReleaseGeometry(g);
}

void Accelerator::State::attach(const AnalyticShape& shape) {
    RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(g, 1);
    rtcSetGeometryUserData(g, const_cast<AnalyticShape*>(&shape));
    rtcSetGeometryBoundsFunction(g, analytic_bounds, nullptr);
    rtcSetGeometryIntersectFunction(g, analytic_intersect);
    rtcSetGeometryOccludedFunction(g, analytic_occluded);
    rtcCommitGeometry(g);
    rtcAttachGeometryByID(scene, g, shape.id);
    rtcReleaseGeometry(g);
}

Accelerator::Accelerator(const std::vector<Shape>& shapes) : state_(std::make_unique<State>()) {
    state_->device = rtcNewDevice(nullptr);
    if (!state_->device) throw RunError("Embree could not create a device");
    state_->scene = rtcNewScene(state_->device);
    // Robust: rays through shared edges and vertices hit one of the triangles, so that closed meshes are closed.
    rtcSetSceneFlags(state_->scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(state_->scene, RTC_BUILD_QUALITY_HIGH);
    state_->analytic.reserve(shapes.size());  // Embree keeps the addresses
    std::size_t primitives = 0;
    for (unsigned id = 0; id < shapes.size(); ++id) {
        const auto* mesh = std::get_if<Mesh>(&shapes[id]);
        if (mesh) state_->attach(*mesh, id);
        else state_->attach(state_->analytic.emplace_back(AnalyticShape{&shapes[id], id}));
        primitives += mesh ? mesh->triangles.size() : 1;
    }
    const auto build = [&] { rtcJoinCommitScene(state_->scene); };
    if (primitives <= serial_build_limit) tbb::task_arena(1).execute(build);
    else build();
    if (rtcGetDeviceError(state_->device) != RTC_ERROR_NONE) throw RunError("Embree could not build the scene's tree");
}

Accelerator::~Accelerator() = default;

std::optional<Intersection> Accelerator::intersect(const Ray& ray) const {
    RTCRayHit query;
    set_ray(query.ray, ray);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
    rtcIntersect1(state_->scene, &query);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(state_->scene, &context, &query);
#endif
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return Intersection{query.hit.geomID, query.hit.primID, query.ray.tfar, query.hit.u, query.hit.v};
}

bool Accelerator::occluded(const Ray& ray) const {
    RTCRay query;
    set_ray(query, ray);
#if RTC_VERSION_MAJOR >= 4
    rtcOccluded1(state_->scene, &query);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(state_->scene, &context, &query);
#endif
    return query.tfar < 0.f;
}

void* Accelerator::native_handle() const { return state_->scene; }

}  // namespace gib
