// Values on a grid (.vol).

#include "common/error.h"
#include "common/grid_volume.h"
#include "tests/fuzz/harness.h"

namespace gib::fuzz {

void run_input(std::string_view input) {
    static const ScratchFolder folder;
    folder.write("input.vol", input);
    try {
        GridVolume::Data data = load_volume(folder / "input.vol");
        for (const auto filter : {VolumeFilter::nearest, VolumeFilter::trilinear})
            for (const auto wrap : {VolumeWrap::clamp, VolumeWrap::repeat, VolumeWrap::mirror}) {
                const GridVolume volume(data, Eigen::Affine3d::Identity(), filter, wrap);
                require((volume.lowest() <= volume.highest()).all(), "bounds are in order");
                for (const Vec3& p : {Vec3(0, 0, 0), Vec3(0.5f, 0.3f, 0.9f), Vec3(-1e30f, 7, 1e30f)}) {
                    const Color value = volume.at(p);
                    // Rounding of an interpolation between finite values; differences of huge ones of either sign overflow.
                    if ((volume.highest() - volume.lowest()).allFinite())
                        require(value.allFinite(), "values are finite");
                }
            }
    } catch (const InputError&) {
    }
}

}  // namespace gib::fuzz
