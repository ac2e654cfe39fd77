#pragma once
// Values on a grid in space: the extinction or the albedo of a heterogeneous medium.

#include "common/core/math.h"

#include <array>
#include <string>
#include <vector>

namespace gib {

enum class VolumeFilter { trilinear, nearest };
enum class VolumeWrap { repeat, mirror, clamp };

/// Mitsuba's meaning: voxel (i, j, k) has its centre at ((i + 0.5) / nx, (j + 0.5) / ny, (k + 0.5) / nz) of a unit
/// cube.
class GridVolume {
public:
    struct Data {
        std::array<int, 3> size;    ///< voxels along x, y and z
        int channels;               ///< 1 or 3
        std::vector<float> values;  ///< channels fastest, then x, y and z
        Eigen::AlignedBox3d box;    ///< the file's own, which counts only where a scene asks for it
    };

    /// One value everywhere.
    explicit GridVolume(const Color& constant) : constant_(constant), lowest_(constant), highest_(constant) {}
    /// `to_grid` carries points of the scene into the unit cube.
    GridVolume(Data data, const Eigen::Affine3d& to_grid, VolumeFilter filter, VolumeWrap wrap);

    bool constant() const { return data_.values.empty(); }
    Color at(const Vec3& p) const { return constant() ? constant_ : interpolated(p); }
    /// Cuts the stretch [begin, end) of the line from + t w down to what lies in the cube; false: nothing is left. A
    /// constant is everywhere.
    bool clip(const Vec3& from, const Vec3& w, float& begin, float& end) const;
    /// Bounds of each channel over all of space.
    const Color& lowest() const { return lowest_; }
    const Color& highest() const { return highest_; }

private:
    Color interpolated(const Vec3& p) const;
    Color voxel(int i, int j, int k) const;

    Color constant_ = Color::Zero();
    Data data_{};
    Eigen::Matrix3f linear_ = Eigen::Matrix3f::Zero();
    Vec3 offset_ = Vec3::Zero();
    VolumeFilter filter_ = VolumeFilter::trilinear;
    VolumeWrap wrap_ = VolumeWrap::clamp;
    Color lowest_, highest_;
};

/// Mitsuba's .vol file: "VOL", version 3, encoding 1 (float32), size, channels, box, values; little-endian. Throws
/// InputError in the file for what is wrong there: other encodings, sizes that do not match the file's, values that are
/// not finite.
GridVolume::Data load_volume(const std::string& path);

}  // namespace gib
