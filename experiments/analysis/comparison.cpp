#include "experiments/analysis/comparison.h"

#include "common/core/number_text.h"
#include "common/images/image_file.h"
#include "experiments/analysis/row_fields.h"
#include "experiments/metrics/flip.h"
#include "experiments/results/pictures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace gib {

namespace {

/// The contests over the totals of the scenes in which a method can be best.
std::vector<std::pair<std::string, Contest>> contests_of(const Analysis& analysis) {
    std::vector<std::pair<std::string, Contest>> contests;
    for (const auto& scene : scenes_of(analysis)) {
        Contest contest(analysis, scene);
        if (contest.methods() > 1 && contest.is_judged()) contests.emplace_back(scene, std::move(contest));
    }
    return contests;
}

std::optional<double> positive_number(const std::string& text) {
    const auto value = number_from<double>(text);
    return value && *value > 0 ? value : std::nullopt;
}

struct BiasPoint {
    double x, bias2, deviation;  ///< deviation: standard error of log bias2
};

/// Fits a line to log bias^2 over log x, in which each point has the weight 1 / deviation^2. The interval widens if
/// the points scatter more than their deviations predict.
PowerFit fitted_law(const std::vector<BiasPoint>& points) {
    double w = 0, wx = 0, wy = 0, wxx = 0, wxy = 0;
    for (const auto& p : points) {
        const double weight = 1 / (p.deviation * p.deviation), x = std::log(p.x), y = std::log(p.bias2);
        w += weight;
        wx += weight * x;
        wy += weight * y;
        wxx += weight * x * x;
        wxy += weight * x * y;
    }
    const double determinant = w * wxx - wx * wx;
    const double slope = (w * wxy - wx * wy) / determinant, offset = (wy - slope * wx) / w;
    double chi2 = 0;
    for (const auto& p : points) {
        const double residual = (std::log(p.bias2) - offset - slope * std::log(p.x)) / p.deviation;
        chi2 += residual * residual;
    }
    const double scatter = std::max(1.0, chi2 / static_cast<double>(points.size() - 2));
    const double half = 1.96 * std::sqrt(w / determinant * scatter);
    return {{-slope, Interval{-slope - half, -slope + half}}, std::exp(offset)};
}

/// Groups of rows whose labels differ only in the value of one parameter: (label without the parameter, its name) ->
/// (value, row).
std::map<std::pair<std::string, std::string>, std::map<double, const TableRow*>> sweeps(const Analysis& analysis,
                                                                                        const std::string& scene,
                                                                                        Layer layer) {
    std::map<std::pair<std::string, std::string>, std::map<double, const TableRow*>> found;
    for (const TableRow& row : analysis.rows) {
        if (row.scene != scene || row.layer != layer) continue;
        const MethodLabel label = MethodLabel::parse(analysis.label_of(row.method));
        for (std::size_t i = 0; i < label.values.size(); ++i) {
            const auto value = positive_number(label.values[i].second);
            if (!value) continue;
            MethodLabel rest = label;
            rest.values.erase(rest.values.begin() + static_cast<std::ptrdiff_t>(i));
            found[{rest.text(), label.values[i].first}][*value] = &row;
        }
    }
    return found;
}

/// A row's name without its setting of this parameter.
std::string name_without(const std::string& parameter, std::string name) {
    const std::size_t at = name.find(" " + parameter + "=");
    if (at == std::string::npos) return name;
    const std::size_t begin = name[at - 1] == ',' ? at - 1 : at;  // names from the experiment file have commas
    return name.erase(begin, std::min(name.find_first_of(", ", at + 1), name.size()) - begin);
}

/// The exponent p of bias^2 = c x^-p of a density estimate over a disc of radius r. Where light is smooth, the bias of
/// the k nearest of N photons is proportional to r^2, as odd terms of its Taylor series cancel, so that bias^2 ~ r^4;
/// the disc holds k photons, so that r^2 ~ k / N (Jensen 2001, chapter 7; Silverman 1986, section 5.2). k=auto grows as
/// N^(2/3). Final gathering and the cache have biases of their own.
std::optional<double> theoretical_exponent(const MethodLabel& rest, const std::string& parameter, Layer layer) {
    const auto value = [&](const char* key) {
        const auto found = std::ranges::find_if(rest.values, [&](const auto& v) { return v.first == key; });
        return found == rest.values.end() ? std::string() : found->second;
    };
    const bool gathers = !value("gather").empty() && value("gather") != "0";
    if (rest.name != "photon_mapper" || (gathers && layer != Layer::caustic)) return std::nullopt;
    if (parameter == "photons") return value("k") == "auto" ? 2. / 3 : 2;
    if (parameter == "k") return -2;
    return std::nullopt;
}

/// A change of the best method counts only if the new error is below this fraction of the old one.
constexpr double least_lead = 0.95;
/// Runs of one budget end with unlike passes, within this share of its time.
constexpr double well_before = 0.9;

/// The mean squared error of some runs as a function of time: infinite before all of them have an image, 0 unless it
/// is above the noise floor.
struct MeanCurve {
    Runs cells;
    double noise_floor;
    double operator()(double seconds) const {
        const auto errors2 = errors2_by(cells, Layer::total, seconds);
        if (errors2.empty()) return std::numeric_limits<double>::infinity();
        const double mean = sample_mean(errors2).value;
        return mean > noise_floor ? mean : 0;
    }
    MeanCurve without(std::size_t seed) const { return {gib::without(cells, seed), noise_floor}; }
};

/// The time at which `challenger` passes `best`, by bisection between a time at which it is behind and one at which
/// it is ahead.
double passing_time(const MeanCurve& best, const MeanCurve& challenger, double behind, double ahead) {
    for (int step = 0; step < 60; ++step) {
        const double middle = std::sqrt(behind * ahead);
        (challenger(middle) < best(middle) ? ahead : behind) = middle;
    }
    return ahead;
}

/// The time at which `challenger` passes `best`; if it does so between several pairs of successive `times`, the one
/// nearest to `near`.
std::optional<double> passing_near(const MeanCurve& best, const MeanCurve& challenger, const std::vector<double>& times,
                                   double near) {
    std::optional<double> nearest;
    for (std::size_t i = 1; i < times.size(); ++i) {
        if (challenger(times[i - 1]) < best(times[i - 1]) || !(challenger(times[i]) < best(times[i]))) continue;
        const double time = passing_time(best, challenger, times[i - 1], times[i]);
        if (!nearest || std::abs(std::log(time / near)) < std::abs(std::log(*nearest / near))) nearest = time;
    }
    return nearest;
}

std::optional<Interval> passing_interval(const MeanCurve& best, const MeanCurve& challenger,
                                         const std::vector<double>& times, double seconds) {
    const std::size_t seeds = std::min(best.cells.size(), challenger.cells.size());
    std::vector<double> logs;
    for (std::size_t s = 0; seeds > 2 && s < seeds; ++s) {
        const auto time = passing_near(best.without(s), challenger.without(s), times, seconds);
        if (!time) return std::nullopt;
        logs.push_back(std::log(*time));
    }
    if (logs.empty()) return std::nullopt;
    const Interval interval = *jackknife(std::log(seconds), logs).interval;
    // The first image of a method comes at one time, whatever seed is left out.
    if (!(interval.hi - interval.lo > 1e-9)) return std::nullopt;
    return Interval{std::exp(interval.lo), std::exp(interval.hi)};
}

/// The scan of one scene through the times of all checkpoints.
class Scan {
public:
    Scan(std::string scene, const Contest& contest) : scene_(std::move(scene)), contest_(contest) {
        std::set<double> times;
        for (const auto& [method, cells] : contest.cells())
            for (const Cell* cell : cells)
                for (const auto& c : cell->checkpoints)
                    times.insert(c.checkpoint.seconds);
        times_.assign(times.begin(), times.end());
    }

    std::vector<Crossover> changes() {
        for (std::size_t i = 0; i < times_.size(); ++i) {
            const auto ranking = contest_.after(times_[i]);
            const Contender* best = best_of(ranking);
            if (!best) continue;
            if (changes_.empty()) add_change({.scene = scene_, .method = best->method, .seconds = times_[i]});
            const Contender& reigning = of_method(ranking, changes_.back().method);
            if (reigning.known != Contender::Known::equal && reigning.standing != Standing::behind) {
                end_reign(reigning.ended);
                changes_.push_back({.scene = scene_,
                                    .method = "",
                                    .before = reigning.method,
                                    .seconds = reigning.ended,
                                    .ends = true});
                return std::move(changes_);
            }
            if (best->method != reigning.method && is_passed(reigning, *best, i)) pass(*best, i);
            compare_rivals(ranking);
        }
        if (!changes_.empty()) end_reign(times_.back());
        return std::move(changes_);
    }

private:
    MeanCurve curve(const std::string& method) const {
        return {contest_.cells().at(method), contest_.noise_floor(method)};
    }
    bool is_passed(const Contender& reigning, const Contender& best, std::size_t i) const {
        if (reigning.known != Contender::Known::equal) return true;
        return std::sqrt(curve(best.method)(times_[i])) < least_lead * std::sqrt(curve(reigning.method)(times_[i]));
    }

    void pass(const Contender& best, std::size_t i) {
        const MeanCurve before = curve(changes_.back().method), after = curve(best.method);
        Crossover change{
            .scene = scene_, .method = best.method, .before = changes_.back().method, .seconds = times_[i]};
        // The new method may have been ahead for a while, but by less than a change needs.
        std::size_t behind = std::max<std::size_t>(i, 1) - 1;
        while (behind > 0 && times_[behind] > changes_.back().seconds && after(times_[behind]) < before(times_[behind]))
            --behind;
        if (after(times_[i]) < before(times_[i])) {
            change.seconds = passing_time(before, after, times_[behind], times_[i]);
            change.interval = passing_interval(before, after, times_, change.seconds);
        }
        end_reign(change.seconds);
        add_change(std::move(change));
    }

    void add_change(Crossover change) {
        change.relative_rmse =
            resolved({curve(change.method)(change.seconds), {}}, contest_.noise_floor(change.method));
        change.doubts.one_seed = contest_.cells().at(change.method).size() < 2;
        changes_.push_back(std::move(change));
        different_.clear();
    }
    /// Names the rivals whose runs had ended before the best method's time was over.
    void end_reign(double seconds) {
        Crossover& now = changes_.back();
        for (const Contender& c : contest_.after(seconds))
            if (c.method != now.method && c.standing == Standing::open && c.ended < well_before * seconds)
                now.doubts.open.push_back(c.method);
    }
    /// A rival counts as not significantly different until the best method differs significantly from it once.
    void compare_rivals(const std::vector<Contender>& ranking) {
        Crossover& now = changes_.back();
        const Contender& own = of_method(ranking, now.method);
        for (const Contender& c : ranking) {
            if (c.method == now.method || !c.is_complete || c.logs.empty() || c.known != Contender::Known::equal)
                continue;
            if (differ_significantly(own, c)) different_.insert(c.method);
            std::vector<std::string>& ties =
                c.logs.size() == 1 && own.logs.size() > 1 ? now.doubts.lone : now.doubts.ties;
            if (different_.count(c.method) > 0) std::erase(ties, c.method);
            else if (std::ranges::find(ties, c.method) == ties.end()) ties.push_back(c.method);
        }
    }

    std::string scene_;
    const Contest& contest_;
    std::vector<double> times_;
    std::vector<Crossover> changes_;
    std::set<std::string> different_;  ///< from the best method since the last change
};

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

/// The last image up to `seconds`, else the first one.
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

std::vector<EqualTimeRow> equal_time_rows(const Analysis& analysis) {
    std::vector<EqualTimeRow> rows;
    for (const auto& scene : scenes_of(analysis))
        for (const Layer layer : layers_of(analysis, scene)) {
            const Contest contest(analysis, scene, layer);
            if (!contest.is_judged()) continue;
            const double seconds = contest.equal_time();
            auto ranking = contest.after(seconds);
            if (ranking.size() < 2 || ranking[1].standing == Standing::no_image) continue;
            rows.push_back({scene, layer, seconds, std::move(ranking), contest.noise_floor()});
        }
    return rows;
}

std::vector<FrontierPoint> pareto_frontier(const Analysis& analysis) {
    std::vector<FrontierPoint> frontier;
    for (const auto& [scene, contest] : contests_of(analysis)) {
        std::map<std::pair<double, double>, FrontierPoint> points;  // by time and squared error
        for (const auto& [method, cells] : contest.cells()) {
            const double floor = contest.noise_floor(method);
            for (const MeanPoint& point : mean_curve(cells, Layer::total)) {
                const double error2 = sample_mean(point.relative).value;
                if (std::isnan(error2)) continue;
                points.try_emplace({point.seconds, std::max(error2, floor)},
                                   FrontierPoint{.scene = scene,
                                                 .method = method,
                                                 .least_passes = point.least_passes,
                                                 .most_passes = point.most_passes,
                                                 .seconds = point.seconds,
                                                 .relative_rmse = resolved({error2, {}}, floor)});
            }
        }
        double best = std::numeric_limits<double>::infinity();
        for (auto& [place, point] : points) {
            if (!(place.second < best)) continue;
            best = place.second;
            point.doubts = doubts_about(point.method, contest.after(point.seconds));
            frontier.push_back(std::move(point));
        }
    }
    return frontier;
}

std::vector<BiasLaw> bias_laws(const Analysis& analysis) {
    std::vector<BiasLaw> laws;
    for (const auto& scene : scenes_of(analysis))
        for (const Layer layer : layers_of(analysis, scene))
            for (const auto& [key, rows] : sweeps(analysis, scene, layer)) {
                if (rows.size() < 3) continue;
                BiasLaw law{.scene = scene,
                            .layer = layer,
                            .method = key.first,
                            .name = name_without(key.second, rows.begin()->second->method),
                            .parameter = key.second,
                            .rows = {rows.begin(), rows.end()},
                            .theory = theoretical_exponent(MethodLabel::parse(key.first), key.second, layer)};
                if (std::ranges::all_of(rows, [](const auto& row) { return row.second->is_unbiased; })) continue;
                std::vector<BiasPoint> points;
                for (const auto& [x, row] : rows) {
                    if (row->is_unbiased || !row->statistics || !row->statistics->bias2) continue;
                    const Estimate& bias2 = *row->statistics->bias2;
                    if (!bias2.interval || !(bias2.interval->lo > 0)) continue;
                    const double width = std::log(bias2.interval->hi / bias2.interval->lo);
                    points.push_back({x, bias2.value, std::max(width, 1e-6) / (2 * 1.96)});
                }
                law.resolved_count = points.size();
                if (points.size() >= 3) law.fit = fitted_law(points);
                laws.push_back(std::move(law));
            }
    return laws;
}

std::vector<Crossover> crossovers(const Analysis& analysis) {
    std::vector<Crossover> all;
    for (const auto& [scene, contest] : contests_of(analysis))
        for (Crossover& change : Scan(scene, contest).changes())
            all.push_back(std::move(change));
    return all;
}

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
