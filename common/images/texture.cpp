#include "common/images/texture.h"

#include <array>
#include <variant>

namespace gib {

namespace {

/// The four texels around a place: (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1).
struct Quad {
    std::array<Color, 4> texels;
    float wx, wy;
};

/// The colour beyond the edges of a bitmap that ends there.
float value_beyond(Wrap wrap) { return wrap == Wrap::one ? 1.f : 0.f; }

Color texel_of(const BitmapTexture& texture, int x, int y) {
    if (x == cell_beyond || y == cell_beyond) return Color::Constant(value_beyond(texture.wrap));
    return texture.bitmap->texel(x, y);
}

Color minimum_of(const BitmapTexture& texture) {
    const Color& texels = texture.bitmap->minimum();
    return ends_at_edges(texture.wrap) ? Color(texels.min(value_beyond(texture.wrap))) : texels;
}

Color maximum_of(const BitmapTexture& texture) {
    const Color& texels = texture.bitmap->maximum();
    return ends_at_edges(texture.wrap) ? Color(texels.max(value_beyond(texture.wrap))) : texels;
}

Quad quad_at(const BitmapTexture& texture, const Vec2& uv) {
    const Bitmap& bitmap = *texture.bitmap;
    const Vec2 st = texture.to_uv(uv);
    const Neighbours x = neighbours(st.x(), bitmap.width(), texture.wrap);
    const Neighbours y = neighbours(st.y(), bitmap.height(), texture.wrap);
    return {{texel_of(texture, x.first, y.first), texel_of(texture, x.second, y.first),
             texel_of(texture, x.first, y.second), texel_of(texture, x.second, y.second)},
            x.weight,
            y.weight};
}

Color color_of(const BitmapTexture& texture, const Vec2& uv) {
    const Bitmap& bitmap = *texture.bitmap;
    if (texture.filter == TextureFilter::nearest) {
        const Vec2 st = texture.to_uv(uv);
        return texel_of(texture, nearest_cell(st.x(), bitmap.width(), texture.wrap),
                        nearest_cell(st.y(), bitmap.height(), texture.wrap));
    }
    const Quad q = quad_at(texture, uv);
    const Color top = (1 - q.wx) * q.texels[0] + q.wx * q.texels[1];
    const Color bottom = (1 - q.wx) * q.texels[2] + q.wx * q.texels[3];
    // The clamp keeps rounding from lifting a reflectance above 1.
    return ((1 - q.wy) * top + q.wy * bottom).max(minimum_of(texture)).min(maximum_of(texture));
}

float number(const Color& c, bool grey) { return grey ? c[0] : luminance(c); }

/// The derivative of the interpolated value with respect to uv. Some versions of Mitsuba multiply by the resolution
/// after to_uv instead of before; their result differs if to_uv mixes the axes of an image that is not square.
Vec2 gradient_of(const BitmapTexture& texture, const Vec2& uv) {
    if (texture.filter == TextureFilter::nearest) return Vec2::Zero();
    const Quad q = quad_at(texture, uv);
    std::array<float, 4> v;
    for (std::size_t i = 0; i < 4; ++i)
        v[i] = number(q.texels[i], texture.bitmap->grey());
    const Vec2 per_texel((1 - q.wy) * (v[1] - v[0]) + q.wy * (v[3] - v[2]),
                         (1 - q.wx) * (v[2] - v[0]) + q.wx * (v[3] - v[1]));
    const Vec2 size(static_cast<float>(texture.bitmap->width()), static_cast<float>(texture.bitmap->height()));
    return texture.to_uv.linear.transpose() * per_texel.cwiseProduct(size);
}

/// Whether both coordinates lie in the same half of their period.
bool on_diagonal(const CheckerboardTexture& texture, const Vec2& uv) {
    const Vec2 st = texture.to_uv(uv);
    return (st.x() - std::floor(st.x()) > 0.5f) == (st.y() - std::floor(st.y()) > 0.5f);
}

Color color_of(const MeshAttributeTexture& attribute, const TexturePoint& at) {
    const std::size_t i = at.triangle;
    if (attribute.per_face) return attribute.colors[i];
    const float b1 = at.weights.x(), b2 = at.weights.y();
    const Color* corner = &attribute.colors[3 * i];
    return (1.f - b1 - b2) * corner[0] + b1 * corner[1] + b2 * corner[2];
}

bool is_grey(const Color& c) { return c[0] == c[1] && c[1] == c[2]; }

}  // namespace

Vec2 UvTransform::operator()(const Vec2& uv) const { return linear * uv + offset; }

struct Texture::Varying {
    /// An attribute with the mean and the bounds of its colours.
    struct Attribute {
        MeshAttributeTexture texture;
        Color mean, minimum, maximum;

        explicit Attribute(MeshAttributeTexture given) : texture(std::move(given)) {
            Colord sum = Colord::Zero();
            minimum = maximum = texture.colors.front();
            for (const Color& c : texture.colors) {
                sum += c.cast<double>();
                minimum = minimum.min(c);
                maximum = maximum.max(c);
            }
            mean = (sum / static_cast<double>(texture.colors.size())).cast<float>();
        }
        /// The clamp keeps rounding from lifting a reflectance above 1.
        Color color(const TexturePoint& at) const { return color_of(texture, at).max(minimum).min(maximum); }
    };
    std::variant<BitmapTexture, CheckerboardTexture, Attribute, ScaledTexture> kind;

    const BitmapTexture* bitmap() const { return std::get_if<BitmapTexture>(&kind); }
    const Attribute* attribute() const { return std::get_if<Attribute>(&kind); }
    const ScaledTexture* scaled() const { return std::get_if<ScaledTexture>(&kind); }
    const CheckerboardTexture& checkerboard() const { return std::get<CheckerboardTexture>(kind); }
};

Texture::Texture(BitmapTexture bitmap) : varying_(std::make_shared<const Varying>(Varying{std::move(bitmap)})) {}
Texture::Texture(CheckerboardTexture checkerboard)
    : varying_(std::make_shared<const Varying>(Varying{std::move(checkerboard)})) {}
Texture::Texture(MeshAttributeTexture attribute)
    : varying_(std::make_shared<const Varying>(Varying{Varying::Attribute(std::move(attribute))})) {}
Texture::Texture(const ScaledTexture& scaled) {
    if (scaled.texture.constant()) constant_ = scaled.texture.constant_ * scaled.scale;
    else varying_ = std::make_shared<const Varying>(Varying{scaled});
}

Color Texture::varying_color(const TexturePoint& at) const {
    if (const auto* bitmap = varying_->bitmap()) return color_of(*bitmap, at.uv);
    if (const auto* attribute = varying_->attribute()) return attribute->color(at);
    if (const auto* scaled = varying_->scaled()) return scaled->texture.color(at) * scaled->scale;
    const auto& board = varying_->checkerboard();
    return (on_diagonal(board, at.uv) ? board.color0 : board.color1).color(at);
}

float Texture::value(const TexturePoint& at) const {
    if (!varying_) return is_grey(constant_) ? constant_[0] : constant_.mean();
    if (const auto* bitmap = varying_->bitmap()) return number(color_of(*bitmap, at.uv), bitmap->bitmap->grey());
    if (const auto* attribute = varying_->attribute()) return number(attribute->color(at), attribute->texture.grey);
    if (const auto* scaled = varying_->scaled())
        return is_grey(scaled->scale) ? scaled->texture.value(at) * scaled->scale[0]
                                      : luminance(scaled->texture.color(at) * scaled->scale);
    const auto& board = varying_->checkerboard();
    return (on_diagonal(board, at.uv) ? board.color1 : board.color0).value(at);
}

Vec2 Texture::gradient(const Vec2& uv) const {
    if (!varying_) return Vec2::Zero();
    if (const auto* scaled = varying_->scaled())
        return has_gradient() ? Vec2(scaled->scale[0] * scaled->texture.gradient(uv)) : Vec2(Vec2::Zero());
    const auto* bitmap = varying_->bitmap();
    return bitmap ? gradient_of(*bitmap, uv) : Vec2(Vec2::Zero());
}

bool Texture::has_gradient() const {
    if (!varying_) return true;
    if (const auto* scaled = varying_->scaled()) return is_grey(scaled->scale) && scaled->texture.has_gradient();
    return varying_->bitmap();
}

Color Texture::mean() const {
    if (!varying_) return constant_;
    if (const auto* bitmap = varying_->bitmap()) return bitmap->bitmap->mean();
    if (const auto* attribute = varying_->attribute()) return attribute->mean;
    if (const auto* scaled = varying_->scaled()) return scaled->texture.mean() * scaled->scale;
    const auto& board = varying_->checkerboard();
    return 0.5f * (board.color0.mean() + board.color1.mean());
}

double Texture::aspect() const {
    if (varying_ && varying_->scaled()) return varying_->scaled()->texture.aspect();
    const auto* bitmap = varying_ ? varying_->bitmap() : nullptr;
    return bitmap ? static_cast<double>(bitmap->bitmap->width()) / bitmap->bitmap->height() : 1;
}

Color Texture::minimum() const {
    if (!varying_) return constant_;
    if (const auto* bitmap = varying_->bitmap()) return minimum_of(*bitmap);
    if (const auto* attribute = varying_->attribute()) return attribute->minimum;
    if (const auto* scaled = varying_->scaled()) return scaled->texture.minimum() * scaled->scale;
    const auto& board = varying_->checkerboard();
    return board.color0.minimum().min(board.color1.minimum());
}

Color Texture::maximum() const {
    if (!varying_) return constant_;
    if (const auto* bitmap = varying_->bitmap()) return maximum_of(*bitmap);
    if (const auto* attribute = varying_->attribute()) return attribute->maximum;
    if (const auto* scaled = varying_->scaled()) return scaled->texture.maximum() * scaled->scale;
    const auto& board = varying_->checkerboard();
    return board.color0.maximum().max(board.color1.maximum());
}

}  // namespace gib
