// The fuzz target of MilkShape 3D ASCII models.

#include "common/mesh_files/mesh_ms3d.h"
#include "tests/fuzz/harness.h"

namespace gib::fuzz {

namespace {

void check_model(const Ms3dModel& model) {
    require(!model.groups.empty(), "a model has a group");
    for (const auto& group : model.groups) {
        check_mesh(group.mesh);
        require(!group.material || *group.material < model.materials.size(), "materials are in range");
    }
    for (const auto& material : model.materials)
        for (const Color& c : {material.diffuse, material.specular, material.emissive})
            require((c >= 0.f).all() && (c <= 1.f).all(), "colours are in range");
}

}  // namespace

void run_input(std::string_view input) {
    unless_refused([&] { check_model(parse_ms3d(input, "input.txt")); });
}

}  // namespace gib::fuzz
