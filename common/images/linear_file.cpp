#include "common/images/linear_file.h"

#include "common/core/error.h"
#include "common/core/memory_limit.h"
#include "common/images/image_library.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace gib {

LinearImage load_linear_image(const std::string& path) {
    const auto reader = image_library().open_image(path, false);
    const ImageReader& file = *reader;
    const int rows = std::min(64, file.height());
    require_memory_for_image(1.0 * file.width() * (3.0 * file.height() + 1.0 * rows * file.channels()), file.width(),
                             file.height(), file.channels(), {path, 0, 0});
    LinearImage image(file.width(), file.height());
    const auto channels = static_cast<std::size_t>(file.channels());
    std::vector<float> values(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(rows) * channels);
    for (int y = 0; y < image.height; y += rows) {
        const int end = std::min(y + rows, image.height);
        file.read_rows(y, end, values.data());
        const std::size_t first = static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width);
        const std::size_t count = static_cast<std::size_t>(end - y) * static_cast<std::size_t>(image.width);
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t k = 0; k < 3; ++k) {
                const float v = values[i * channels + (channels == 3 ? k : 0)];
                if (!std::isfinite(v))
                    throw InputError({path, 0, 0}, fmt::format("the pixel in column {}, row {} is not finite: {}",
                                                               (first + i) % static_cast<std::size_t>(image.width),
                                                               (first + i) / static_cast<std::size_t>(image.width), v));
                image.rgb[3 * (first + i) + k] = v;
            }
    }
    return image;
}

}  // namespace gib
