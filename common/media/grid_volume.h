#pragma once
// Values on a grid in space, such as the extinction or the albedo of a heterogeneous medium.

#include "common/core/math.h"
#include "common/core/wrap.h"

#include <array>
#include <string>
#include <vector>

namespace gib {

enum class VolumeFilter { trilinear, nearest };

/// As in Mitsuba, voxel (i, j, k) of a unit cube has its centre at ((i + 0.5) / nx, (j + 0.5) / ny, (k + 0.5) / nz).
class GridVolume {
public:
    struct Data {
        std::array<int, 3> size;    ///< voxels along x, y and z
        int channels;               ///< 1 or 3
        std::vector<float> values;  ///< channels fastest, then x, y and z
        Eigen::AlignedBox3d box;    ///< the file's own box, used only if a scene asks for it
    };

    /// A volume with the same value everywhere.
    explicit GridVolume(const Color& constant) : constant_(constant), lowest_(constant), highest_(constant) {}
    /// The same with a cube, that `to_grid` carries into the unit cube, for clip().
    GridVolume(const Color& constant, const Eigen::Affine3d& to_grid);
    /// `to_grid` carries points of the scene into the unit cube.
    GridVolume(Data data, const Eigen::Affine3d& to_grid, VolumeFilter filter, Wrap wrap);

    bool constant() const { return data_.values.empty(); }
    /// Whether all channels have the same value everywhere.
    bool grey() const { return constant() ? (constant_ == constant_[0]).all() : data_.channels == 1; }
    Color at(const Vec3& p) const { return constant() ? constant_ : interpolated(p); }
    /// Clips the stretch [begin, end) of the line from + t w to the part that lies in the cube; false if nothing is
    /// left. A volume without a cube fills all of space.
    bool clip(const Vec3& from, const Vec3& w, float& begin, float& end) const;
    /// Bounds of each channel over all of space.
    const Color& lowest() const { return lowest_; }
    const Color& highest() const { return highest_; }

private:
    Color interpolated(const Vec3& p) const;
    Color voxel(int i, int j, int k) const;

    Color constant_ = Color::Zero();
    bool has_cube_ = false;
    Data data_{};
    Eigen::Matrix3f linear_ = Eigen::Matrix3f::Zero();
    Vec3 offset_ = Vec3::Zero();
    VolumeFilter filter_ = VolumeFilter::trilinear;
    Wrap wrap_ = Wrap::clamp;
    Color lowest_, highest_;
};

/// Reads Mitsuba's .vol file: "VOL", version 3, encoding 1 (float32), size, channels, box, values; little-endian.
/// Throws InputError at the file for other encodings, a size that does not match the number of values, and values
/// that are not finite.
GridVolume::Data load_volume(const std::string& path);

}  // namespace gib
