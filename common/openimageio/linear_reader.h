#pragma once
// Reads an image file row by row as linear floats with OpenImageIO. common/images/image_library.h says which files it
// accepts and how it decodes them.

#include "common/core/error.h"
#include "common/images/image_library.h"

#include <OpenImageIO/imageio.h>
#include <vector>

namespace gib {

/// Opens a file that must be a flat image with pixels. Otherwise throws InputError with the file's name.
std::unique_ptr<OIIO::ImageInput> open_file(const std::string& path, const OIIO::ImageSpec* config = nullptr);
/// Throws InputError if the file has more than one part. To be called before or after the first part is read,
/// not during it.
void require_one_part(OIIO::ImageInput& file, const SourceLocation& where);

class LinearReader final : public ImageReader {
public:
    LinearReader(const std::string& path, bool raw, const std::string& channel);

    int width() const override { return file_->spec().width; }
    int height() const override { return file_->spec().height; }
    int channels() const override { return static_cast<int>(channels_.size()); }
    void read_rows(int begin, int end, float* values) const override;

private:
    float linear(float stored) const;

    std::string path_;
    std::unique_ptr<OIIO::ImageInput> file_;
    std::vector<int> channels_;   ///< indices of the channels to read: one as grey, or R, G, B
    std::vector<float> decoded_;  ///< the linear value of each byte, if the file holds bytes in sRGB
    bool srgb_ = false;
};

}  // namespace gib
