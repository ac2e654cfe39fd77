#include "experiments/references/batches.h"

#include "experiments/system/interrupt.h"

#include <utility>

namespace gib {

namespace {

/// Batches that have taken longer than this [s] are kept when Ctrl-C ends their round.
constexpr double batch_worth_keeping = 5;

}  // namespace

Batches::Batches(const std::vector<ReferenceMaker>& makers, std::string key, const std::string& path, bool keeps_all)
    : makers_(makers), key_(std::move(key)), folder_(batch_folder_of(path)), keeps_all_(keeps_all) {}

MadeBatch Batches::made(const ReferenceBatch& batch) {
    if (auto stored = folder_.read(batch)) {
        used_.push_back(batch);
        return *std::move(stored);
    }
    MadeBatch made = made_batch(makers_[batch.maker], key_, batch);
    if (keeps_all_ || made.seconds > batch_worth_keeping) {
        folder_.write(batch, made);
        used_.push_back(batch);
    }
    return made;
}

void Batches::remove_used() {
    for (const ReferenceBatch& batch : used_)
        folder_.remove(batch);
    used_.clear();
}

BatchFolder batch_folder_of(const std::string& path) { return BatchFolder(path + ".batches"); }

MadeBatch made_batch(const ReferenceMaker& maker, const std::string& key, const ReferenceBatch& batch) {
    return maker.make(batch_seed(key, batch.number, batch.maker), batch.passes, batch.passes_before,
                      [] { InterruptGuard::check(); });
}

}  // namespace gib
