#pragma once
// Colours and numbers that vary over a surface, as Mitsuba's textures define them (variant scalar_rgb).

#include "common/core/wrap.h"
#include "common/images/texture_bitmap.h"
#include "common/images/texture_point.h"

#include <memory>
#include <vector>

namespace gib {

enum class TextureFilter { bilinear, nearest };

/// Maps a surface's uv to a texture's st: st = linear uv + offset.
struct UvTransform {
    Eigen::Matrix2f linear = Eigen::Matrix2f::Identity();
    Vec2 offset = Vec2::Zero();

    Vec2 operator()(const Vec2& uv) const;
};

class Texture;

/// An image as a texture. Column 0 starts at s = 0 and row 0, the topmost, at t = 0; texel (x, y) has its centre at
/// ((x + 0.5) / width, (y + 0.5) / height). Values are decoded to linear before they are filtered.
struct BitmapTexture {
    std::shared_ptr<const Bitmap> bitmap;
    TextureFilter filter = TextureFilter::bilinear;
    Wrap wrap = Wrap::repeat;
    UvTransform to_uv{};
};

/// A checkerboard of 2 x 2 squares in [0, 1]^2, repeated.
struct CheckerboardTexture;

/// Another texture times a colour.
struct ScaledTexture;

/// Colours of one mesh (Mitsuba's `mesh_attribute`): three for each triangle, at its vertices, which are interpolated
/// linearly, or one for each triangle.
struct MeshAttributeTexture {
    std::vector<Color> colors;
    bool per_face = false;
    bool grey = false;  ///< the attribute is a number, not a colour
};

/// A colour that varies over a surface: a constant, a bitmap, a checkerboard, an attribute of the surface's mesh, or
/// one of these times a colour.
/// Cheap to copy: pixels are shared.
class Texture {
public:
    explicit Texture(const Color& constant) : constant_(constant) {}
    explicit Texture(BitmapTexture bitmap);
    explicit Texture(CheckerboardTexture checkerboard);
    explicit Texture(MeshAttributeTexture attribute);
    explicit Texture(const ScaledTexture& scaled);

    bool constant() const { return !varying_; }
    /// The colour at a place: linear RGB with sRGB's primaries, within minimum() and maximum() everywhere. A coordinate
    /// that is not finite counts as 0. Throws RunError if the file of a paged image has disappeared. An attribute is
    /// looked up on the mesh that it belongs to.
    Color color(const TexturePoint& at) const { return varying_ ? varying_color(at) : constant_; }
    /// The texture as one number, as Mitsuba's eval_1 returns it: a grey value itself, the luminance of a bitmap's
    /// colour, or the mean of a constant colour's channels. The two colours of a checkerboard are exchanged here, as
    /// they are in Mitsuba. Of an attribute's colour it is the luminance, too; Mitsuba refuses it. A grey scale
    /// multiplies this number; with a coloured one it is the luminance of the product.
    float value(const TexturePoint& at) const;
    /// The derivative of value() with respect to (u, v), per unit of uv. It is 0 for the filter `nearest` and
    /// for a checkerboard and an attribute.
    Vec2 gradient(const Vec2& uv) const;
    /// Whether value() has a derivative; a checkerboard and an attribute have none.
    bool has_gradient() const;

    /// The mean over all texels, over all colours of an attribute, or over both colours of a checkerboard with equal
    /// weight. It is the mean over uv in [0, 1]^2 if `to_uv` maps this square to itself.
    Color mean() const;
    /// Width / height of the texels of a bitmap; 1 of other textures.
    double aspect() const;
    /// Lower and upper bounds of each channel.
    Color minimum() const;
    Color maximum() const;

private:
    struct Varying;
    Color varying_color(const TexturePoint& at) const;

    Color constant_ = Color::Zero();
    std::shared_ptr<const Varying> varying_;  ///< null: a constant
};

struct CheckerboardTexture {
    Texture color0{Color::Constant(0.4f)};  ///< colour where s and t are in the same half of their period
    Texture color1{Color::Constant(0.2f)};
    UvTransform to_uv;  ///< applies to the squares, not to textures in them
};

struct ScaledTexture {
    Texture texture;
    Color scale;  ///< not negative
};

}  // namespace gib
