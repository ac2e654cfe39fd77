#include "tests/fuzz/harness.h"

#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace gib::fuzz {

namespace {

/// The largest coordinate that Embree, and so a scene, accepts; scene_shape.cpp refuses shapes beyond it.
constexpr double largest_coordinate = 1.8e18;

bool in_range(const MeshData& mesh) {
    return std::all_of(mesh.positions.begin(), mesh.positions.end(),
                       [](const Vec3d& p) { return (p.array().abs() <= largest_coordinate).all(); });
}

void check_finished(const MeshData& mesh) {
    require(mesh.normals.size() == mesh.positions.size(), "a normal for each vertex");
    for (const Vec3& n : mesh.normals)
        require(n.isZero(0) || std::abs(n.norm() - 1.f) < 1e-5f, "normals are unit or zero");
    for (const auto& t : mesh.triangles) {
        const Vec3d& v = mesh.positions[t[0]];
        require(std::isfinite((mesh.positions[t[1]] - v).cross(mesh.positions[t[2]] - v).stableNorm()), "areas");
    }
}

}  // namespace

void require(bool holds, const std::string& what) {
    if (!holds) throw std::logic_error("does not hold: " + what);
}

void check_mesh(const MeshData& mesh) {
    const std::size_t vertices = mesh.positions.size();
    require(!mesh.triangles.empty(), "a mesh has triangles");
    for (const auto& triangle : mesh.triangles)
        for (const auto index : triangle)
            require(index < vertices, "indices are in range");
    require(mesh.normals.empty() || mesh.normals.size() == vertices, "a normal for each vertex, or none");
    require(mesh.uvs.empty() || mesh.uvs.size() == vertices, "a uv for each vertex, or none");
    for (const Vec3d& p : mesh.positions)
        require(p.allFinite(), "positions are finite");
    for (const Vec3& n : mesh.normals)
        require(n.allFinite(), "normals are finite");
    for (const Vec2& uv : mesh.uvs)
        require(uv.allFinite(), "uv are finite");

    Mat4d turned = Mat4d::Identity();
    turned.topLeftCorner<3, 3>() << 0, 2, 0, -1, 0, 0, 0, 0.5, 1e-3;
    Mat4d tiny = Mat4d::Identity();
    tiny.topLeftCorner<3, 3>() = Vec3d(1e-110, -1e-110, 1e-110).asDiagonal();
    for (const Mat4d& to_world : {Mat4d(Mat4d::Identity()), turned, tiny}) {
        MeshData moved = mesh;
        transform_mesh(moved, to_world);
        if (!in_range(moved)) continue;
        compute_normals(moved);
        check_finished(moved);
    }
}

ScratchFolder::ScratchFolder() {
    namespace fs = std::filesystem;
    const fs::path memory = "/dev/shm";
    parent_ = (fs::exists(memory) ? memory : fs::temp_directory_path()) / ("gib-fuzz-" + std::to_string(::getpid()));
    path_ = parent_ + "/input";
    fs::create_directories(path_);
}

ScratchFolder::~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(parent_, ignored);
}

void ScratchFolder::write(const std::string& name, std::string_view content) const {
    std::ofstream file(*this / name, std::ios::binary | std::ios::trunc);
    file.write(content.data(), static_cast<std::streamsize>(content.size()));
    require(file.good(), "the scratch folder can be written");
}

void ScratchFolder::remove(const std::string& name) const { std::filesystem::remove(*this / name); }

}  // namespace gib::fuzz
