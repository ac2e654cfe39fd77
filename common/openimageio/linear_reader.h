#pragma once
// An image file by OpenImageIO, row by row as linear floats. What it accepts and refuses stands in
// common/images/linear_file.h.

#include "common/core/error.h"
#include "common/images/image_library.h"

#include <OpenImageIO/imageio.h>
#include <vector>

namespace gib {

/// A flat image with pixels. Throws InputError with the file's name.
std::unique_ptr<OIIO::ImageInput> open_file(const std::string& path, const OIIO::ImageSpec* config = nullptr);
/// After its only part was read, or before: throws InputError if there are more.
void require_one_part(OIIO::ImageInput& file, const SourceLocation& where);

class LinearReader final : public ImageReader {
public:
    LinearReader(const std::string& path, bool raw);

    int width() const override { return file_->spec().width; }
    int height() const override { return file_->spec().height; }
    int channels() const override { return static_cast<int>(channels_.size()); }
    void read_rows(int begin, int end, float* values) const override;

private:
    float linear(float stored) const;

    std::string path_;
    std::unique_ptr<OIIO::ImageInput> file_;
    std::vector<int> channels_;   ///< one grey or R, G, B
    std::vector<float> decoded_;  ///< the linear value of each byte, if the file holds bytes in sRGB
    bool srgb_ = false;
};

}  // namespace gib
