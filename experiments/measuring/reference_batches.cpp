#include "experiments/measuring/reference_batches.h"

#include "common/core/error.h"
#include "common/core/number_text.h"
#include "common/images/image_digest.h"
#include "common/images/image_file.h"
#include "common/sampling/sampler.h"

#include <fmt/format.h>

#include <filesystem>

namespace gib {

namespace {

namespace fs = std::filesystem;

const std::vector<std::string> digest_keys = {"work", "seconds", "not_finite", "first_not_finite"};
constexpr const char* digest_key = "digest";

template <typename Number>
Number number_in(const LayeredImage& file, const std::string& key) {
    const auto entry = file.metadata.find(key);
    const auto value = entry == file.metadata.end() ? std::nullopt : number_from<Number>(entry->second);
    if (!value) throw InputError("no number");
    return *value;
}

}  // namespace

std::string BatchFolder::file_of(const ReferenceBatch& batch) const {
    return fmt::format("{}/maker{}-batch{}-passes{}-after{}.exr", path_, batch.maker, batch.number, batch.passes,
                       batch.passes_before);
}

bool BatchFolder::has(const ReferenceBatch& batch) const {
    std::error_code ignored;
    return fs::exists(file_of(batch), ignored);
}

std::optional<MadeBatch> BatchFolder::read(const ReferenceBatch& batch) const {
    if (!has(batch)) return std::nullopt;
    try {
        const LayeredImage file = read_image(file_of(batch));
        const auto digest = file.metadata.find(digest_key);
        if (digest == file.metadata.end() || digest->second != image_digest(file, digest_keys)) return std::nullopt;
        MadeBatch made{.images = components_in(file),
                       .dropped = {number_in<std::uint64_t>(file, "not_finite"), ""},
                       .work = number_in<double>(file, "work"),
                       .seconds = number_in<double>(file, "seconds")};
        if (const auto first = file.metadata.find("first_not_finite"); first != file.metadata.end())
            made.dropped.first = first->second;
        return made;
    } catch (const std::exception&) {  // any exception, because a damaged file can contain anything
        return std::nullopt;
    }
}

void BatchFolder::write(const ReferenceBatch& batch, const MadeBatch& made) const {
    fs::create_directories(path_);
    LayeredImage file = layers_of(made.images);
    file.metadata = {{"work", fmt::format("{}", made.work)},
                     {"seconds", fmt::format("{}", made.seconds)},
                     {"not_finite", fmt::format("{}", made.dropped.count)},
                     {"first_not_finite", made.dropped.count > 0 ? made.dropped.first : "none"}};
    file.metadata[digest_key] = image_digest(file, digest_keys);
    write_exr(file_of(batch), file);
}

void BatchFolder::remove(const ReferenceBatch& batch) const {
    std::error_code ignored;
    fs::remove(file_of(batch), ignored);
}

void BatchFolder::remove_all() const {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

std::uint64_t batch_seed(const std::string& key, std::uint32_t batch, std::uint32_t maker) {
    const std::uint64_t base = std::stoull(key.substr(0, 16), nullptr, 16);
    return 0x8000000000000000ull | combine_keys(base, std::uint64_t{maker} << 32 | batch);
}

}  // namespace gib
