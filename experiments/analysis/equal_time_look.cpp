#include "experiments/analysis/equal_time_look.h"

#include "common/images/image_file.h"
#include "experiments/analysis/contest.h"
#include "experiments/metrics/flip.h"
#include "experiments/results/flip_record.h"
#include "experiments/results/frames.h"

#include <algorithm>

namespace gib {

namespace {

/// The stored images of a cell: frames and the final image, in the order of time.
std::vector<Checkpoint> stored_images(const Cell& cell, const ResultFolder& folder) {
    const std::string name = cell_folder_name(cell.scene, cell.method, cell.seed);
    std::vector<Checkpoint> images;
    for (const auto& [checkpoint, errors] : cell.checkpoints)
        if (keeps_frame(cell.seed, checkpoint.passes, cell.last().passes) && has_frame(folder, name, checkpoint.passes))
            images.push_back(checkpoint);
    images.push_back(cell.last());
    return images;
}

/// An image that comes later than the compared time by at most this share of it still counts as one at that time: the
/// time budgets of methods end with a pass.
constexpr double latest = 0.1;

/// The last image by `seconds`; the first one if there is none by then.
Checkpoint image_by(const std::vector<Checkpoint>& images, double seconds) {
    Checkpoint shown = images.front();
    for (const Checkpoint& image : images)
        if (image.seconds <= (1 + latest) * seconds) shown = image;
    return shown;
}

std::optional<double> flip_of(const Cell& cell, std::uint32_t passes, const Judgement& judgement,
                              const ResultFolder& folder) {
    const std::string name = cell_folder_name(cell.scene, cell.method, cell.seed);
    const Image& r = judgement.total().mean;
    if (passes == cell.last().passes)
        return cell_flip(folder, name, judgement.total_of(read_image(folder.cell_image(name))), r);
    const auto frame = read_frame(folder, name, passes);
    const Image small = reduced(r, reduction_for(r.width, r.height, frame_size));
    if (!frame || !frame->same_size(small) || frame->non_finite_values() + small.non_finite_values() > 0) return {};
    return hdr_flip(*frame, small).mean();
}

}  // namespace

std::vector<EqualTimeLook> equal_time_looks(const Analysis& analysis, const std::string& scene,
                                            const Judgement& judgement, const ResultFolder& folder) {
    std::vector<EqualTimeLook> looks;
    const Contest contest(analysis, scene);
    if (contest.methods() == 0) return looks;
    const double seconds = contest.equal_time();
    for (const auto& method : analysis.index.methods) {
        const auto found = contest.cells().find(method);
        if (found == contest.cells().end() || found->second.front()->seed != 1) continue;
        const Runs& cells = found->second;
        const Cell& first = *cells.front();
        const Checkpoint image =
            mean_seconds(cells) <= seconds ? first.last() : image_by(stored_images(first, folder), seconds);
        looks.push_back({.scene = scene,
                         .method = method,
                         .passes = image.passes,
                         .seconds = image.seconds,
                         .is_final = image.passes == first.last().passes});
        if (!judgement.is_empty()) looks.back().flip = flip_of(first, image.passes, judgement, folder);
    }
    return looks;
}

}  // namespace gib
