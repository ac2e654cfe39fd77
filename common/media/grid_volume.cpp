#include "common/media/grid_volume.h"

#include "common/core/binary.h"
#include "common/core/error.h"
#include "common/core/files.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace gib {

namespace {

/// How a file holds its values. A byte of 255 means 1 (the documentation of Mitsuba 0.6, `gridvolume`).
constexpr std::int32_t float32_encoding = 1, uint8_encoding = 3;

/// Reads a file's values one after another.
class BinaryCursor {
public:
    BinaryCursor(const std::string& bytes, const std::string& path) : bytes_(bytes), path_(path) {}

    template <typename T>
    T next(const char* what) {
        if (bytes_.size() - at_ < sizeof(T)) fail(fmt::format("the file ends in {}", what));
        at_ += sizeof(T);
        return load<T>(bytes_.data() + at_ - sizeof(T));
    }
    std::size_t rest() const { return bytes_.size() - at_; }
    [[noreturn]] void fail(const std::string& message) const { throw InputError({path_}, message); }

private:
    const std::string& bytes_;
    const std::string& path_;
    std::size_t at_ = 0;
};

}  // namespace

GridVolume::GridVolume(const Color& constant, const Eigen::Affine3d& to_grid) : GridVolume(constant) {
    has_cube_ = true;
    linear_ = to_grid.linear().cast<float>();
    offset_ = to_grid.translation().cast<float>();
}

GridVolume::GridVolume(Data data, const Eigen::Affine3d& to_grid, VolumeFilter filter, Wrap wrap)
    : has_cube_(true),
      data_(std::move(data)),
      linear_(to_grid.linear().cast<float>()),
      offset_(to_grid.translation().cast<float>()),
      filter_(filter),
      wrap_(wrap) {
    lowest_ = highest_ = voxel(0, 0, 0);
    for (int k = 0; k < data_.size[2]; ++k)
        for (int j = 0; j < data_.size[1]; ++j)
            for (int i = 0; i < data_.size[0]; ++i) {
                lowest_ = lowest_.min(voxel(i, j, k));
                highest_ = highest_.max(voxel(i, j, k));
            }
}

Color GridVolume::voxel(int i, int j, int k) const {
    const auto at = [](int index, int size) {
        return static_cast<std::size_t>(index) * static_cast<std::size_t>(size);
    };
    const std::size_t row = static_cast<std::size_t>(j) + at(k, data_.size[1]);
    const std::size_t index = static_cast<std::size_t>(i) + row * static_cast<std::size_t>(data_.size[0]);
    const float* v = &data_.values[index * static_cast<std::size_t>(data_.channels)];
    return data_.channels == 3 ? Color(v[0], v[1], v[2]) : Color::Constant(v[0]);
}

bool GridVolume::clip(const Vec3& from, const Vec3& w, float& begin, float& end) const {
    if (!has_cube_) return begin < end;
    const Vec3 o = linear_ * from + offset_, d = linear_ * w;
    for (int axis = 0; axis < 3; ++axis) {
        if (d[axis] == 0.f) {
            if (!(o[axis] >= 0.f && o[axis] <= 1.f)) return false;
            continue;
        }
        const float a = -o[axis] / d[axis], b = (1.f - o[axis]) / d[axis];
        begin = std::max(begin, std::min(a, b));
        end = std::min(end, std::max(a, b));
    }
    return begin < end;
}

Color GridVolume::interpolated(const Vec3& p) const {
    const Vec3 in_cube = linear_ * p + offset_;
    if (filter_ == VolumeFilter::nearest)
        return voxel(nearest_cell(in_cube.x(), data_.size[0], wrap_), nearest_cell(in_cube.y(), data_.size[1], wrap_),
                     nearest_cell(in_cube.z(), data_.size[2], wrap_));
    const Neighbours x = neighbours(in_cube.x(), data_.size[0], wrap_),
                     y = neighbours(in_cube.y(), data_.size[1], wrap_),
                     z = neighbours(in_cube.z(), data_.size[2], wrap_);
    const auto along_x = [&](int j, int k) {
        const Color a = voxel(x.first, j, k);
        return Color(a + x.weight * (voxel(x.second, j, k) - a));
    };
    const auto along_y = [&](int k) {
        const Color a = along_x(y.first, k);
        return Color(a + y.weight * (along_x(y.second, k) - a));
    };
    const Color a = along_y(z.first);
    return a + z.weight * (along_y(z.second) - a);
}

GridVolume::Data load_volume(const std::string& path) {
    const std::string bytes = read_file(path);
    BinaryCursor cursor(bytes, path);
    const auto magic = cursor.next<std::array<char, 3>>("its first bytes");
    if (std::string_view(magic.data(), magic.size()) != "VOL") cursor.fail("no volume: it does not start with VOL");
    if (const int version = cursor.next<std::uint8_t>("its version"); version != 3)
        cursor.fail(fmt::format("version {} is not supported; 3 is", version));
    const auto encoding = cursor.next<std::int32_t>("its encoding");
    if (encoding != float32_encoding && encoding != uint8_encoding)
        cursor.fail(fmt::format("encoding {} is not supported; {}, float32, and {}, uint8, are", encoding,
                                float32_encoding, uint8_encoding));
    GridVolume::Data data;
    std::size_t values = 1;
    for (int& size : data.size) {
        size = cursor.next<std::int32_t>("its size");
        if (size < 1 || size > 4096) cursor.fail(fmt::format("a side of {} voxels; 1 to 4096 are supported", size));
        values *= static_cast<std::size_t>(size);
    }
    data.channels = cursor.next<std::int32_t>("its number of channels");
    if (data.channels != 1 && data.channels != 3)
        cursor.fail(fmt::format("{} channels; 1 or 3 are supported", data.channels));
    values *= static_cast<std::size_t>(data.channels);
    for (int corner = 0; corner < 2; ++corner)
        for (int axis = 0; axis < 3; ++axis)
            (corner == 0 ? data.box.min() : data.box.max())[axis] = static_cast<double>(cursor.next<float>("its box"));
    const std::size_t bytes_of_values = values * (encoding == uint8_encoding ? 1 : sizeof(float));
    if (cursor.rest() != bytes_of_values)
        cursor.fail(fmt::format("{} bytes of values where its size asks for {}", cursor.rest(), bytes_of_values));
    const char* first = bytes.data() + (bytes.size() - cursor.rest());
    data.values.resize(values);
    if (encoding == float32_encoding) std::memcpy(data.values.data(), first, bytes_of_values);
    else
        std::transform(first, first + values, data.values.begin(),
                       [](char byte) { return static_cast<float>(static_cast<unsigned char>(byte)) / 255.f; });
    if (!std::all_of(data.values.begin(), data.values.end(), [](float v) { return std::isfinite(v); }))
        cursor.fail("a value is not finite");
    return data;
}

}  // namespace gib
