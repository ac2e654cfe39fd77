#include "common/images/image.h"

namespace gib {

Image ComponentImages::total() const {
    Image sum(width, height);
    for (const auto& part : parts)
        if (part)
            for (std::size_t i = 0; i < sum.rgb.size(); ++i)
                sum.rgb[i] += part->rgb[i];
    return sum;
}

}  // namespace gib
