#pragma once
// Colours and numbers that vary over a surface, with the meaning that Mitsuba's textures have (variant scalar_rgb).

#include "common/images/texture_bitmap.h"

#include <memory>

namespace gib {

enum class TextureFilter { bilinear, nearest };
enum class TextureWrap { repeat, mirror, clamp };

/// A surface's uv to a texture's st: st = linear uv + offset.
struct UvTransform {
    Eigen::Matrix2f linear = Eigen::Matrix2f::Identity();
    Vec2 offset = Vec2::Zero();

    Vec2 operator()(const Vec2& uv) const { return linear * uv + offset; }
};

class Texture;

/// Column 0 lies at s = 0 and row 0, the topmost, at t = 0; texel (x, y) has its centre at ((x + 0.5) / width,
/// (y + 0.5) / height). Filtering comes after the decoding to linear values.
struct BitmapTexture {
    std::shared_ptr<const Bitmap> bitmap;
    TextureFilter filter = TextureFilter::bilinear;
    TextureWrap wrap = TextureWrap::repeat;
    UvTransform to_uv{};
};

/// 2 x 2 squares in [0, 1]^2, repeated.
struct CheckerboardTexture;

/// A colour that varies over a surface: a constant, a bitmap or a checkerboard. Cheap to copy: pixels are shared.
class Texture {
public:
    explicit Texture(const Color& constant) : constant_(constant) {}
    explicit Texture(BitmapTexture bitmap);
    explicit Texture(CheckerboardTexture checkerboard);

    bool constant() const { return !varying_; }
    /// Linear RGB, sRGB's primaries. Within minimum() and maximum() for every uv; a coordinate that is not finite
    /// counts as 0. Throws RunError if an image that is paged has disappeared.
    Color color(const Vec2& uv) const { return varying_ ? varying_color(uv) : constant_; }
    /// One number, as Mitsuba's eval_1: a grey; the luminance of a bitmap's colour; the mean of the channels of a
    /// constant one. A checkerboard has its two colours exchanged here: Mitsuba keeps this convention of old.
    float value(const Vec2& uv) const;
    /// d value / d (u, v), per unit of uv. 0 for the filter `nearest`.
    Vec2 gradient(const Vec2& uv) const;
    /// A checkerboard has none.
    bool has_gradient() const;

    /// Over all texels, or both colours of a checkerboard alike: over uv in [0, 1]^2 if `to_uv` keeps that.
    Color mean() const;
    /// Bounds of each channel.
    Color minimum() const;
    Color maximum() const;

private:
    struct Varying;
    Color varying_color(const Vec2& uv) const;

    Color constant_ = Color::Zero();
    std::shared_ptr<const Varying> varying_;  ///< null: a constant
};

struct CheckerboardTexture {
    Texture color0{Color::Constant(0.4f)};  ///< where s and t are in the same half of their period
    Texture color1{Color::Constant(0.2f)};
    UvTransform to_uv;  ///< of the squares, not of textures in them
};

}  // namespace gib
