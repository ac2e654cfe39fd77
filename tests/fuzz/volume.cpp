// The fuzz target of values on a grid (.vol files).

#include "common/media/grid_volume.h"
#include "tests/fuzz/harness.h"

namespace gib::fuzz {

namespace {

void check_volume(const GridVolume& volume) {
    require((volume.lowest() <= volume.highest()).all(), "bounds are in order");
    // The interpolation's differences between values of either sign can overflow; a scene accepts no values below 0.
    if (!(volume.lowest() >= 0.f).all()) return;
    for (const Vec3& p : {Vec3(0, 0, 0), Vec3(0.5f, 0.3f, 0.9f), Vec3(-1e30f, 7, 1e30f)})
        require(volume.at(p).allFinite(), "values are finite");
}

}  // namespace

void run_input(std::string_view input) {
    static const ScratchFolder folder;
    folder.write("input.vol", input);
    unless_refused([&] {
        const GridVolume::Data data = load_volume(folder / "input.vol");
        for (const auto filter : {VolumeFilter::nearest, VolumeFilter::trilinear})
            for (const auto wrap : {Wrap::clamp, Wrap::repeat, Wrap::mirror})
                check_volume(GridVolume(data, Eigen::Affine3d::Identity(), filter, wrap));
    });
}

}  // namespace gib::fuzz
