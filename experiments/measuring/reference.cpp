#include "experiments/measuring/reference.h"

#include "common/core/files.h"
#include "common/images/image_file.h"
#include "common/scene/scene.h"
#include "experiments/measuring/pilot_rules.h"
#include "experiments/measuring/reference_agreement.h"
#include "experiments/measuring/reference_makers.h"
#include "experiments/measuring/reference_schedule.h"
#include "experiments/measuring/reference_store.h"
#include "experiments/metrics/denominators.h"
#include "experiments/metrics/epsilon.h"
#include "experiments/plan/label_checks.h"
#include "experiments/system/build_info.h"
#include "experiments/system/interrupt.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <set>
#include <utility>

namespace gib {

namespace {

/// Batches that have taken longer than this [s] are kept when Ctrl-C ends their round.
constexpr double batch_worth_keeping = 5;
/// Least time between two writes of the file [s]: short rounds are not worth a write each.
constexpr double save_interval = 15;
/// A reference ends when its squared error is so many of its own standard errors below the target.
constexpr double stopping_margin = 1;
/// If one group carries more than this share of the scatter, the standard error is unreliable; Gaussian noise gives
/// about 0.27 (dominance_of_one_group()).
constexpr double heavy_tail_share = 0.5;
/// Noise is skewed if the plain formula of the standard error, with the image's own noise in the denominator, differs from the one
/// that is free of it by this factor.
constexpr double skewed_by = 1.25;
double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// The folder of the batches of the reference at this path.
BatchFolder batch_folder_of(const std::string& path) { return BatchFolder(path + ".batches"); }

MadeBatch made_batch(const ReferenceMaker& maker, const std::string& key, const ReferenceBatch& batch) {
    return maker.make(batch_seed(key, batch.number, batch.maker), batch.passes, batch.passes_before,
                      [] { InterruptGuard::check(); });
}

/// Makes one reference.
class Maker {
public:
    Maker(const ReferenceWork& work, ProgressLine& progress)
        : work_(work),
          progress_(progress),
          key_(reference_key(work.scene.content_hash, work.label, work.seed)),
          batches_(batch_folder_of(work.path)),
          schedule_(work.goal),
          agreement_(work.methods.size()) {
        unresolved_.assign(all_components.begin(), all_components.end());
        for (const MethodDescription* method : work.methods) {
            const ReferenceMaker& maker =
                makers_.emplace_back(*method, work.label, work.scene, work.label.name == auto_reference);
            std::erase_if(unresolved_, [&](Component c) {
                return std::ranges::find(maker.unresolved(), c) == maker.unresolved().end();
            });
            shares_.push_back({maker.name(), 1, {}});
            shares_.back().weights.fill(1);
        }
    }

    FinishedReference make() {
        require_memory_for_reference(work_.scene.scene->sensor().width(), work_.scene.scene->sensor().height());
        open();
        // The shares decide how many passes are enough, so that they are read before that is asked.
        const bool has_shares = makers_.size() == 1 || take_stored_shares();
        bool done = good_enough();
        if (!done && !has_shares && !run_pilot()) return unfinished();
        while (!done) {
            if (!may_make(schedule_.next_batches(state(), shares_), schedule_.batches_ahead(state(), shares_)))
                return unfinished();
            try {
                add_round();
            } catch (const Interrupted&) {
                if (unsaved_) save();
                throw;
            }
            if (unsaved_ && now() - saved_at_ > save_interval) save();
            done = good_enough();
        }
        compare_with_pilots();
        if (unsaved_) save();
        batches_.remove_all();
        warn_about_quality();
        result_.reference.metadata = metadata();
        result_.identity = fmt::format("{}:{}", key_, groups_.passes);
        return std::move(result_);
    }

    /// For make_batch().
    static void make_one(const ReferenceWork& work, const ReferenceBatch& batch) {
        const BatchFolder folder = batch_folder_of(work.path);
        if (folder.read(batch)) return;
        const ReferenceMaker maker(*work.methods.at(batch.maker), work.label, work.scene,
                                   work.label.name == auto_reference);
        folder.write(batch, made_batch(maker, reference_key(work.scene.content_hash, work.label, work.seed), batch));
    }

private:
    void open() {
        saved_at_ = now();
        if (!std::filesystem::exists(work_.path)) return;
        const auto& sensor = work_.scene.scene->sensor();
        try {
            groups_ = ReferenceGroups::read(work_.path, key_, sensor.width(), sensor.height());
            const auto metadata = exr_attributes(work_.path).value();
            stored_shares_ = attribute_in(metadata, "makers");
            for (const ReferenceMaker& maker : makers_)
                if (maker.makes_remainder() && stored_shares_.find(maker.name()) == std::string::npos)
                    throw InputError({work_.path}, "it lacks what '" + maker.name() + "' makes");
            agreement_.read(agreement_file(), agreement_state());
            // Without the pilots, earlier doubts cannot be tested again.
            if (const auto names = metadata.find("unresolved"); names != metadata.end() && !agreement_.has_pilots())
                unresolved_ = components_named(names->second);
        } catch (const std::exception& error) {  // any exception, because a damaged file can contain anything
            result_.warnings.push_back(
                fmt::format("the stored reference cannot be used and is made again: {}", error.what()));
            groups_ = ReferenceGroups();
            return;
        }
        update();
    }

    void update() {
        result_.reference = groups_.reference();
        result_.reference.unresolved = unresolved_;
        result_.epsilon = epsilon_of(work_.epsilon, result_.reference.total.mean);
        const ReferenceLayer& total = result_.reference.total;
        const Denominators denominators(total, result_.epsilon);
        const SampleMean variance = denominators.variance_of(total);
        const double bias = relative_bias(total, denominators);
        error2_ = variance.value + sqr(bias);
        error2_scatter_ = std::sqrt(variance.variance.variance);
        result_.relative_error = std::sqrt(error2_);
        plain_error_ = relative_standard_error(total, Denominators(total.mean, result_.epsilon));
        if (!std::isfinite(result_.relative_error))
            throw RunError(
                fmt::format("the reference of '{}' by '{}' is not finite", work_.scene.name, work_.label.text()));
    }

    bool good_enough() {
        if (groups_.passes == 0) return false;
        const auto& goal = work_.goal;
        if (schedule_.reaches_target(state(), shares_)) return true;
        if (!goal.seconds || groups_.seconds < *goal.seconds) return false;
        if (goal.target)
            result_.warnings.push_back(fmt::format(
                "the reference's relative error is {:.3g} %, or up to {:.3g} %, after {}; its target was {:.3g} %",
                100 * result_.relative_error, 100 * error_up_to(2), duration_text(groups_.seconds),
                100 * *goal.target));
        return true;
    }

    ReferenceState state() const {
        return {.rounds = groups_.rounds,
                .passes = groups_.passes,
                .error = error_up_to(stopping_margin),
                .work = groups_.work,
                .seconds = groups_.seconds,
                .pilot_seconds = pilot_seconds_,
                .pilot_work = pilot_work_,
                .unit_work = unit_work_,
                .foreseen_work = foreseen_work_};
    }
    /// The relative error, so many standard errors of its square above the estimate.
    double error_up_to(double standard_errors) const { return std::sqrt(error2_ + standard_errors * error2_scatter_); }

    /// Whether this process may make those of the batches that are not there. If not, result_.missing has those of
    /// `ahead`.
    bool may_make(const std::vector<ReferenceBatch>& batches, const std::vector<ReferenceBatch>& ahead) {
        if (!work_.most_own_work) return true;
        const auto there = [&](const ReferenceBatch& batch) { return batches_.has(batch); };
        if (std::ranges::all_of(batches, there)) return true;
        if (schedule_.work_left(state(), shares_) <= *work_.most_own_work) return true;
        for (const ReferenceBatch& batch : ahead)
            if (!there(batch)) result_.missing.push_back(batch);
        return false;
    }

    FinishedReference unfinished() {
        if (unsaved_) save();
        return std::move(result_);
    }

    /// The shares of an earlier session, whose images the stored groups hold.
    bool take_stored_shares() {
        const std::vector<MakerShare> stored = shares_in(stored_shares_);
        if (stored.size() != shares_.size()) return false;
        for (std::size_t m = 0; m < stored.size(); ++m)
            if (stored[m].method != shares_[m].method) return false;
        shares_ = stored;
        return true;
    }

    /// Measures the makers and decides their shares by the last round of each. Each round has twice the passes of the one before,
    /// and leaves out the makers that the one before has outdone, until a few per cent of the work are done that the reference is
    /// predicted to take. Returns false if others have to make its batches.
    bool run_pilot() {
        std::vector<std::string> names;
        for (const ReferenceMaker& maker : makers_)
            names.push_back(maker.name());
        DroppedSamples dropped;
        std::vector<MakerPilot> pilots(makers_.size());
        for (std::size_t m = 0; m < makers_.size(); ++m)
            pilots[m].unresolved = makers_[m].unresolved();
        std::vector<bool> outdone(makers_.size(), false);
        for (std::uint32_t round = 0, passes = first_pilot_passes;; ++round, passes *= 2) {
            std::vector<ReferenceBatch> batches;
            for (std::uint32_t m = 0; m < makers_.size(); ++m) {
                if (outdone[m]) continue;
                MakerPilot& pilot = pilots[m];
                if (round == 1) {
                    pilot.first_groups = std::move(pilot.groups);
                    pilot.first_passes = pilot.passes;
                }
                pilot.groups.clear();
                pilot.passes = passes;
                pilot.work = 0;
                for (std::uint32_t g = 0; g < pilot_groups; ++g)
                    batches.push_back({m, first_pilot_batch + round * pilot_groups + g, passes, 0});
            }
            if (!may_make(batches, batches)) return false;
            for (const ReferenceBatch& batch : batches) {
                progress_.update(0, std::nullopt,
                                 fmt::format("reference of {}: trying {}", work_.scene.name, names[batch.maker]));
                MadeBatch made = run_batch(batch);
                MakerPilot& pilot = pilots[batch.maker];
                pilot.groups.push_back(std::move(made.images));
                pilot.work += made.work;
                pilot_work_ += made.work;
                pilot_seconds_ += made.seconds;
                dropped.add(made.dropped);
            }
            for (std::size_t m = 0; m < makers_.size(); ++m)
                agreement_.set_pilot(m, pilots[m].groups);
            const auto& goal = work_.goal;
            const auto plan_for = [&](double work) {
                return plan_of_least_variance(names, pilots, work_.epsilon, work);
            };
            const MakerPlan plan = plan_for(goal.target    ? plan_for(0).error2_work / sqr(*goal.target)
                                            : goal.seconds ? pilot_work_ / pilot_seconds_ * *goal.seconds
                                                           : 0);
            shares_ = plan.shares;
            for (std::size_t m = 0; m < makers_.size(); ++m)
                outdone[m] = outdone[m] || plan.outdone[m];
            unit_work_ = reference_groups * plan.unit_work;
            if (goal.target) foreseen_work_ = plan.error2_work / sqr(*goal.target);
            const bool enough = goal.target && pilot_work_ > pilot_share * foreseen_work_;
            const bool late =
                goal.seconds && pilot_seconds_ > (goal.target ? pilot_share_of_limit : pilot_share) * *goal.seconds;
            if (enough || late || round + 1 == most_pilot_rounds) break;
        }
        groups_.seconds += pilot_seconds_;
        groups_.dropped.add(dropped);
        return true;
    }

    void add_round() {
        const std::uint32_t passes = schedule_.next_passes(state(), shares_);
        std::vector<std::vector<ComponentImages>> made(makers_.size());  // by maker, the images of the groups
        DroppedSamples dropped = groups_.dropped;                        // a copy: an interrupted round does not count
        double seconds = 0, work = 0;
        std::vector<ComponentImages> round;
        std::vector<ComponentImages> images(makers_.size());  // images of one group, by maker
        const std::vector<ReferenceBatch> batches = schedule_.next_batches(state(), shares_);
        for (std::size_t i = 0; i < batches.size(); ++i) {
            show(static_cast<double>(i) / static_cast<double>(batches.size()) * passes);
            MadeBatch batch = run_batch(batches[i]);
            images[batches[i].maker] = std::move(batch.images);
            dropped.add(batch.dropped);
            seconds += batch.seconds;
            work += batch.work;
            if (i + 1 < batches.size() && batches[i + 1].number == batches[i].number) continue;
            round.push_back(makers_.size() == 1 ? images.front() : combined(shares_, images));
            for (std::size_t m = 0; makers_.size() > 1 && m < makers_.size(); ++m)
                if (shares_[m].passes > 0) made[m].push_back(std::move(images[m]));
        }
        for (std::size_t m = 0; m < makers_.size(); ++m)
            if (!made[m].empty()) agreement_.add(m, made[m], passes * shares_[m].passes);
        groups_.add_round(round, passes);
        groups_.dropped = dropped;
        groups_.seconds += seconds;
        groups_.work += work;
        ++result_.rounds_added;
        unsaved_ = true;
        update();
        leave_out_lacking();
    }

    /// If two makers disagree about a component, the one that has found less light lacks some. If it makes the component, it makes
    /// no more of it, and the reference begins again with new seeds, so that weights do not depend on the images that they weigh.
    /// The maker that is left is compared with the pilots at the end.
    void leave_out_lacking() {
        const auto samples = [&](std::size_t m, Component c) {
            const auto& unresolved = makers_[m].unresolved();
            return std::ranges::find(unresolved, c) == unresolved.end() && !lacks_.count({m, c});
        };
        const std::vector<Disagreement> all = agreement_.between_makers(samples);
        const auto found = std::ranges::find_if(
            all, [&](const Disagreement& one) { return shares_[one.lesser()].weight(one.component) > 0; });
        if (found == all.end()) return;
        const Component c = found->component;
        lacks_.emplace(found->lesser(), c);
        leave_to_others(shares_, c, found->lesser(), found->greater());
        lacking_.push_back(fmt::format("'{}' lacks light of {} that '{}' has found: {}; it made none of it",
                                       shares_[found->lesser()].method, name_of(c), shares_[found->greater()].method,
                                       text_of(found->where)));
        groups_.restart();
        agreement_.restart();
        pilot_seconds_ = groups_.seconds;  // the passes of this time are given up
        unsaved_ = false;
    }

    /// Leaves the components unresolved about which a pilot and the finished reference disagree.
    void compare_with_pilots() {
        for (const Disagreement& found : agreement_.with_pilots(groups_.groups())) {
            if (std::ranges::find(unresolved_, found.component) == unresolved_.end())
                unresolved_.push_back(found.component);
            unsaved_ = unsaved_ || result_.rounds_added > 0;  // else the file says so already
            lacking_.push_back(
                fmt::format("'{}' has seen light of {} that the reference lacks: {}; left out of judgement",
                            shares_[found.a].method, name_of(found.component), text_of(found.where)));
        }
        result_.reference.unresolved = unresolved_;
    }

    /// A batch from the folder of batches, or made now. It stays there until the file holds its round.
    MadeBatch run_batch(const ReferenceBatch& batch) {
        if (auto stored = batches_.read(batch)) {
            used_.push_back(batch);
            return *std::move(stored);
        }
        MadeBatch made = made_batch(makers_[batch.maker], key_, batch);
        if (work_.most_own_work || made.seconds > batch_worth_keeping) {
            batches_.write(batch, made);
            used_.push_back(batch);
        }
        return made;
    }

    void show(double passes_of_round) {
        const auto& goal = work_.goal;
        const double done = static_cast<double>(groups_.passes) + passes_of_round, seconds = groups_.seconds;
        double fraction = 0, left = infinity;
        if (goal.target && groups_.passes > 0) {
            const double all = static_cast<double>(groups_.passes) + schedule_.passes_needed(state(), shares_);
            fraction = done / all;
            left = seconds * (all - done) / static_cast<double>(groups_.passes);
        }
        if (goal.seconds && left > *goal.seconds - seconds) {
            left = std::max(0.0, *goal.seconds - seconds);
            fraction = seconds / (seconds + left + 1e-9);
        }
        const std::string error =
            groups_.passes > 0 ? fmt::format(", error {:.3g} %", 100 * result_.relative_error) : "";
        progress_.update(fraction, groups_.passes > 0 ? std::optional(left) : std::nullopt,
                         fmt::format("reference of {}: {} samples a pixel{}", work_.scene.name,
                                     static_cast<std::uint64_t>(reference_groups) * groups_.passes, error));
    }

    void save() {
        result_.reference.metadata = metadata();
        write_reference(work_.path, result_.reference);
        if (makers_.size() > 1) agreement_.write(agreement_file(), agreement_state());
        for (const ReferenceBatch& batch : used_)
            batches_.remove(batch);
        used_.clear();
        saved_at_ = now();
        unsaved_ = false;
    }

    /// The file of what MakerAgreement keeps, beside the reference.
    std::string agreement_file() const { return work_.path + ".makers.exr"; }
    std::string agreement_state() const { return fmt::format("{} {} {}", key_, groups_.rounds, groups_.passes); }

    void warn_about_quality() {
        result_.warnings.insert(result_.warnings.end(), lacking_.begin(), lacking_.end());
        std::vector<std::string_view> names;
        for (Component c : unresolved_)
            names.push_back(name_of(c));
        if (!names.empty())
            result_.warnings.push_back(fmt::format("'{}' has not found all light of: {}; left out of judgement",
                                                   work_.label.text(), fmt::join(names, ", ")));
        if (!result_.reference.total.bias.empty())
            result_.warnings.push_back(
                fmt::format("merging has biased the reference by an estimated {:.2g} %, which its "
                            "error and all intervals include",
                            100 * relative_bias(result_.reference.total, {result_.reference.total, result_.epsilon})));
        else if (!work_.methods.front()->unbiased)
            result_.warnings.push_back(
                fmt::format("the reference's method '{}' is biased: its standard error does not hold the bias",
                            work_.label.text()));
        if (groups_.dropped.count > 0)
            result_.warnings.push_back(
                fmt::format("{} samples of the reference were not finite and were dropped; first: {}",
                            groups_.dropped.count, groups_.dropped.first));
        const double skew = plain_error_ > 0 ? result_.relative_error / plain_error_ : 1;
        if (skew > skewed_by || skew < 1 / skewed_by)
            result_.warnings.push_back(fmt::format(
                "the reference's noise is skewed: its error is {:.3g} %, up to {:.3g} %, though it would seem to be "
                "{:.3g} % with its own noise in the denominator",
                100 * result_.relative_error, 100 * error_up_to(2), 100 * plain_error_));
        const double share = dominance_of_one_group(result_.reference.total.groups);
        if (share > heavy_tail_share)
            result_.warnings.push_back(
                fmt::format("heavy tails: one group of {} carries {:.0f} % of the reference's scatter; its standard "
                            "error is uncertain",
                            reference_groups, 100 * share));
    }

    std::map<std::string, std::string> metadata() const {
        std::map<std::string, std::string> metadata = {
            {"reference_key", key_},
            {"scene", work_.scene.name},
            {"scene_hash", work_.scene.content_hash},
            {"method", work_.label.text()},
            {"groups", std::to_string(reference_groups)},
            {"passes", std::to_string(groups_.passes)},
            {"rounds", std::to_string(groups_.rounds)},
            {"seconds", fmt::format("{:.3f}", groups_.seconds)},
            {"work", fmt::format("{}", groups_.work)},
            {"seed_base", fmt::format("{}", batch_seed(key_, 0))},
            {"glossy_roughness", fmt::format("{}", glossy_roughness)},
            {"relative_error", fmt::format("{:.6g}", result_.relative_error)},
            {"epsilon", fmt::format("{}", result_.epsilon)},
            {"dominance_of_one_group", fmt::format("{:.3g}", dominance_of_one_group(result_.reference.total.groups))},
            {"brightest_light", fmt::format("{}", brightest_radiance(work_.scene.scene->lights()))},
            {"program", program_version()}};
        if (makers_.size() > 1) metadata["makers"] = text_of(shares_);
        if (groups_.dropped.count > 0) {
            metadata["not_finite"] = std::to_string(groups_.dropped.count);
            metadata["first_not_finite"] = groups_.dropped.first;
        }
        return metadata;
    }

    const ReferenceWork& work_;
    ProgressLine& progress_;
    std::string key_;
    BatchFolder batches_;
    ReferenceSchedule schedule_;
    std::vector<ReferenceMaker> makers_;
    std::vector<Component> unresolved_;  ///< components that no maker can sample
    std::vector<MakerShare> shares_;
    MakerAgreement agreement_;
    std::string stored_shares_;
    std::vector<std::string> lacking_;                   ///< what makers or pilots disagree about
    std::set<std::pair<std::size_t, Component>> lacks_;  ///< the components that makers lack light of
    double error2_ = 0, error2_scatter_ = 0;     ///< squared relative error, and the standard error of this estimate
    double plain_error_ = 0;                     ///< the relative error with the image itself in the denominator
    std::vector<ReferenceBatch> used_;           ///< batches used from their folder since the file was written
    double pilot_seconds_ = 0, pilot_work_ = 0;  ///< time [s] and work of a pilot of this session
    double unit_work_ = 0, foreseen_work_ = 0;   ///< work of a unit of all groups, and up to the target, by the pilot
    ReferenceGroups groups_;
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
    return Maker(work, progress).make();
}

void make_batch(const ReferenceWork& work, const ReferenceBatch& batch) { Maker::make_one(work, batch); }

std::string stored_reference_identity(const std::string& path) {
    const auto metadata = exr_attributes(path);
    if (!metadata || metadata->count("reference_key") == 0 || metadata->count("passes") == 0) return "";
    return metadata->at("reference_key") + ":" + metadata->at("passes");
}

}  // namespace gib
