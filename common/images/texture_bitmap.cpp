#include "common/images/texture_bitmap.h"

namespace gib {

Bitmap::Bitmap(const std::string& path, bool raw)
    : image_(image_library().read_linear(path, raw)),
      minimum_(Color::Constant(infinity)),
      maximum_(Color::Constant(-infinity)) {
    Colord sum = Colord::Zero();
    for (int y = 0; y < height(); ++y)
        for (int x = 0; x < width(); ++x) {
            const Color c = texel(x, y);
            sum += c.cast<double>();
            minimum_ = minimum_.min(c);
            maximum_ = maximum_.max(c);
        }
    mean_ = (sum / (static_cast<double>(width()) * height())).cast<float>();
}

}  // namespace gib
