#include "experiments/references/reference.h"

#include "common/core/files.h"
#include "common/images/image_file.h"
#include "common/scene/scene.h"
#include "experiments/plan/label_checks.h"
#include "experiments/references/pilot.h"
#include "experiments/references/rounds.h"
#include "experiments/references/verdicts.h"
#include "experiments/system/build_info.h"
#include "experiments/system/interrupt.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <utility>

namespace gib {

namespace {

/// Least time between two writes of the file [s]: short rounds are not worth a write each.
constexpr double save_interval = 15;
/// Batches that have taken longer than this [s] are kept when Ctrl-C ends their round.
constexpr double batch_worth_keeping = 5;
double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

ReferenceMethod method_of(const ReferenceWork& work, const MethodDescription& method) {
    return {method, work.label, work.scene, work.label.name == auto_reference};
}

std::vector<ReferenceMethod> methods_of(const ReferenceWork& work) {
    std::vector<ReferenceMethod> methods;
    for (const MethodDescription* method : work.methods)
        methods.push_back(method_of(work, *method));
    return methods;
}

MadeBatch made_batch(const ReferenceMethod& method, const std::string& key, const ReferenceBatch& batch) {
    return method.make(batch_seed(key, batch.number, batch.method), batch.passes, batch.passes_before,
                       [] { InterruptGuard::check(); });
}

/// One reference on its way from its file, if there is one, to its goal and back.
class Making {
public:
    Making(const ReferenceWork& work, ProgressLine& progress)
        : work_(work),
          progress_(progress),
          key_(reference_key(work.scene.content_hash, work.label, work.seed)),
          methods_(methods_of(work)),
          batches_(work.path),
          rounds_(methods_, work.goal, work.epsilon),
          verdicts_(methods_) {}

    FinishedReference finished() {
        open();
        // The shares decide how many passes are enough, so that they are read before that is asked.
        const bool has_shares = methods_.size() == 1 || take_stored_shares();
        bool done = good_enough();
        if (!done && !has_shares && !run_pilot()) return unfinished();
        while (!done) {
            if (!may_make(rounds_.next_batches(), rounds_.batches_ahead())) return unfinished();
            try {
                add_round();
            } catch (const Interrupted&) {
                if (unsaved_) save();
                throw;
            }
            if (unsaved_ && now() - saved_at_ > save_interval) save();
            done = good_enough();
        }
        // Without a new round the stored file names these components already.
        if (verdicts_.compare_with_pilots(rounds_) && result_.rounds_added > 0) unsaved_ = true;
        if (unsaved_) save();
        batches_.remove_all();
        std::ranges::move(verdicts_.warnings(rounds_, work_.label, *work_.methods.front()),
                          std::back_inserter(result_.warnings));
        result_.identity = fmt::format("{}:{}", key_, rounds_.groups.units);
        return taken();
    }

private:
    void open() {
        saved_at_ = now();
        if (!std::filesystem::exists(work_.path)) return;
        const auto& sensor = work_.scene.scene->sensor();
        try {
            rounds_.groups = ReferenceGroups::read(work_.path, key_, sensor.width(), sensor.height());
            const auto metadata = exr_attributes(work_.path).value();
            stored_shares_ = attribute_in(metadata, "makers");
            for (const ReferenceMethod& method : methods_)
                if (method.makes_remainder() && stored_shares_.find(method.name()) == std::string::npos)
                    throw InputError({work_.path}, "it lacks what '" + method.name() + "' makes");
            const auto names = metadata.find("unresolved");
            verdicts_.read(agreement_file(), agreement_state(), names == metadata.end() ? nullptr : &names->second);
        } catch (const std::exception& error) {  // any exception, because a damaged file can contain anything
            result_.warnings.push_back(
                fmt::format("the stored reference cannot be used and is made again: {}", error.what()));
            rounds_.groups = ReferenceGroups();
            stored_shares_.clear();
            return;
        }
        estimate();
    }

    void estimate() {
        rounds_.estimate();
        if (!std::isfinite(rounds_.error().value()))
            throw RunError(
                fmt::format("the reference of '{}' by '{}' is not finite", work_.scene.name, work_.label.text()));
    }

    bool good_enough() {
        if (rounds_.groups.units == 0) return false;
        if (rounds_.reaches_target()) return true;
        if (!rounds_.is_late()) return false;
        if (const auto& target = work_.goal.target)
            result_.warnings.push_back(fmt::format(
                "the reference's relative error is {:.3g} %, or up to {:.3g} %, after {}; its target was {:.3g} %",
                100 * rounds_.error().value(), 100 * rounds_.error().up_to(2), duration_text(rounds_.groups.seconds),
                100 * *target));
        return true;
    }

    /// The batch from the folder, or a new one. New ones are kept there for other processes, or if they have taken
    /// long.
    MadeBatch made(const ReferenceBatch& batch) {
        std::optional<MadeBatch> made = batches_.read(batch);
        if (!made) {
            made = made_batch(methods_[batch.method], key_, batch);
            if (!work_.most_own_work && made->seconds <= batch_worth_keeping) return *std::move(made);
            batches_.write(batch, *made);
        }
        used_.push_back(batch);
        return *std::move(made);
    }

    /// Whether this process may make those of the batches that are not there. If not, result_.missing has those of
    /// `ahead`.
    bool may_make(const std::vector<ReferenceBatch>& batches, const std::vector<ReferenceBatch>& ahead) {
        if (!work_.most_own_work) return true;
        const auto there = [&](const ReferenceBatch& batch) { return batches_.has(batch); };
        if (std::ranges::all_of(batches, there)) return true;
        if (rounds_.work_left() <= *work_.most_own_work) return true;
        for (const ReferenceBatch& batch : ahead)
            if (!there(batch)) result_.missing.push_back(batch);
        return false;
    }

    FinishedReference unfinished() {
        if (unsaved_) save();
        return rounds_.groups.units > 0 ? taken() : std::move(result_);
    }

    FinishedReference taken() {
        result_.relative_error = rounds_.error().value();
        result_.epsilon = rounds_.epsilon();
        result_.reference = stored();
        return std::move(result_);
    }

    /// The reference as its file has it.
    Reference stored() const {
        Reference reference = rounds_.reference();
        reference.unresolved = verdicts_.unresolved();
        reference.metadata = metadata();
        return reference;
    }

    /// The shares of an earlier session, whose images the stored groups hold. Methods that are new since then, the last
    /// ones, take no part.
    bool take_stored_shares() {
        std::vector<MethodShare> stored = shares_in(stored_shares_);
        if (stored.empty() || stored.size() > rounds_.shares.size()) return false;
        for (std::size_t m = 0; m < rounds_.shares.size(); ++m) {
            if (m == stored.size()) stored.push_back({rounds_.shares[m].method, 0, {}});
            if (stored[m].method != rounds_.shares[m].method) return false;
        }
        rounds_.shares = stored;
        return true;
    }

    /// Measures the methods and decides their shares. Returns false if other processes have to make the pilot's
    /// batches.
    bool run_pilot() {
        Pilot pilot(methods_, work_.goal, work_.epsilon);
        const auto show = [&](const std::string& method) {
            progress_.update(0, std::nullopt, fmt::format("reference of {}: trying {}", work_.scene.name, method));
        };
        for (bool goes_on = true; goes_on;) {
            const auto batches = pilot.next_batches();
            if (!may_make(batches, batches)) return false;
            goes_on = pilot.add_round([&](const ReferenceBatch& batch) { return made(batch); }, show);
            rounds_.shares = pilot.shares();
            rounds_.pilot = pilot.costs();
        }
        verdicts_.keep_pilot(pilot);
        rounds_.groups.seconds += pilot.costs().seconds;
        rounds_.groups.dropped.add(pilot.dropped());
        return true;
    }

    void add_round() {
        const std::uint32_t units = rounds_.next_units();
        const RoundImages images = rounds_.add([&](const ReferenceBatch& batch) { return made(batch); },
                                               [&](double of_round) { show(of_round); });
        verdicts_.keep_round(images, rounds_.shares, units);
        ++result_.rounds_added;
        unsaved_ = true;
        estimate();
        if (!verdicts_.leaves_out_lacking(rounds_.shares)) return;
        rounds_.restart();
        unsaved_ = false;
    }

    void show(double units_of_round) {
        const auto [fraction, left] = rounds_.progress(units_of_round);
        const bool has_error = rounds_.groups.units > 0;
        progress_.update(fraction, has_error ? std::optional(left) : std::nullopt,
                         fmt::format("reference of {}: {} samples a pixel{}", work_.scene.name,
                                     reference_groups * passes_in(rounds_.shares, rounds_.groups.units),
                                     has_error ? fmt::format(", error {:.3g} %", 100 * rounds_.error().value()) : ""));
    }

    void save() {
        write_reference(work_.path, stored());
        if (methods_.size() > 1) verdicts_.write(agreement_file(), agreement_state());
        for (const ReferenceBatch& batch : used_)
            batches_.remove(batch);
        used_.clear();
        saved_at_ = now();
        unsaved_ = false;
    }

    /// The file of what MethodAgreement keeps, beside the reference.
    std::string agreement_file() const { return work_.path + ".makers.exr"; }
    std::string agreement_state() const {
        return fmt::format("{} {} {}", key_, rounds_.groups.rounds, rounds_.groups.units);
    }

    std::map<std::string, std::string> metadata() const {
        std::map<std::string, std::string> metadata = {
            {"reference_key", key_},
            {"method", work_.label.text()},
            {"groups", std::to_string(reference_groups)},
            {"passes", std::to_string(rounds_.groups.units)},
            {"rounds", std::to_string(rounds_.groups.rounds)},
            {"seconds", fmt::format("{:.3f}", rounds_.groups.seconds)},
            {"work", fmt::format("{}", rounds_.groups.work)},
            {"seed_base", fmt::format("{}", batch_seed(key_, 0))},
            {"glossy_roughness", fmt::format("{}", glossy_roughness)},
            {"relative_error", fmt::format("{:.6g}", rounds_.error().value())},
            {"epsilon", fmt::format("{}", rounds_.epsilon())},
            {"dominance_of_one_group", fmt::format("{:.3g}", dominance_of_one_group(rounds_.reference().total.groups))},
            {"brightest_light", fmt::format("{}", brightest_radiance(work_.scene.scene->lights()))},
            {"program", program_version()}};
        metadata.merge(scene_attributes(work_.scene));
        if (methods_.size() > 1) metadata["makers"] = text_of(rounds_.shares);
        if (rounds_.groups.dropped.count > 0) {
            metadata["not_finite"] = std::to_string(rounds_.groups.dropped.count);
            metadata["first_not_finite"] = rounds_.groups.dropped.first;
        }
        return metadata;
    }

    const ReferenceWork& work_;
    ProgressLine& progress_;
    std::string key_;
    std::vector<ReferenceMethod> methods_;
    BatchFolder batches_;
    std::vector<ReferenceBatch> used_;  ///< of the folder; the reference's file will hold their rounds
    Rounds rounds_;
    Verdicts verdicts_;
    std::string stored_shares_;
    FinishedReference result_;
    double saved_at_ = 0;
    bool unsaved_ = false;
};

}  // namespace

std::string reference_key(const std::string& content_hash, const MethodLabel& label, std::uint64_t seed) {
    ContentHash hash;
    hash.add("reference 2");
    hash.add(content_hash);
    hash.add(label.text());
    hash.add(fmt::format("{}", glossy_roughness));  // it decides which component a path belongs to
    if (seed != 1) hash.add(fmt::format("seed {}", seed));
    return hash.hex();
}

std::string cached_reference_path(const std::string& key) { return "results/references/" + key + ".exr"; }

std::vector<const MethodDescription*> methods_for(const LoadedScene& scene, const MethodLabel& label) {
    auto methods = reference_methods(label);
    std::erase_if(methods, [&](const MethodDescription* method) {
        const ConfiguredMethod configured({method->name, label.values});
        return label.name == auto_reference &&
               !configured.create({scene.max_edges})->plan(*scene.scene).same_as.empty();
    });
    return methods;
}

FinishedReference make_reference(const ReferenceWork& work, ProgressLine& progress) {
    require_memory_for_reference(work.scene.scene->sensor().width(), work.scene.scene->sensor().height());
    return Making(work, progress).finished();
}

void make_batch(const ReferenceWork& work, const ReferenceBatch& batch) {
    const BatchFolder folder(work.path);
    if (folder.read(batch)) return;
    const ReferenceMethod method = method_of(work, *work.methods.at(batch.method));
    folder.write(batch, made_batch(method, reference_key(work.scene.content_hash, work.label, work.seed), batch));
}

std::string stored_reference_identity(const std::string& path) {
    const auto metadata = exr_attributes(path);
    if (!metadata || metadata->count("reference_key") == 0 || metadata->count("passes") == 0) return "";
    return metadata->at("reference_key") + ":" + metadata->at("passes");
}

}  // namespace gib
