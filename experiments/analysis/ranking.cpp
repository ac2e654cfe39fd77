#include "experiments/analysis/ranking.h"

#include "common/core/math.h"
#include "experiments/analysis/row_fields.h"
#include "experiments/metrics/price_law.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace gib {

namespace {

bool counts(const Contender& c) { return c.is_complete && !c.logs.empty() && c.known == Contender::Known::equal; }

/// The upper end of the interval of a contender's logarithm; infinite for one seed.
double upper_end(const Contender& c) {
    const double half = half_width(c.scatter, tie_tail);
    return std::isfinite(half) ? c.log_mean + half : std::numeric_limits<double>::infinity();
}

Standing standing_beside(const Contender& best, const Contender& c) {
    if (c.logs.empty()) return Standing::no_image;
    if (!c.is_complete) return Standing::incomplete;
    if (c.is_close) return Standing::open;
    if (c.known == Contender::Known::equal) {
        if (std::min(best.logs.size(), c.logs.size()) < 2) return Standing::one_seed;
        return differ_significantly(best, c) ? Standing::behind : Standing::tie;
    }
    const bool behind_by_law = c.by_law && c.by_law->lo > upper_end(best);
    const bool behind_by_bounds = c.known == Contender::Known::lower_bounds && differ_significantly(best, c);
    return behind_by_law || behind_by_bounds ? Standing::behind : Standing::open;
}

/// A run counts as ended at a time that it missed by no more than this share of its own, because runs end with a pass.
constexpr double end_slack = 0.02;
constexpr double least_error2 = 1e-30;  // has a logarithm, unlike 0

}  // namespace

void set_scatter(std::vector<Contender>& contenders) {
    double sum = 0, degrees = 0;
    for (Contender& c : contenders) {
        const SampleMean mean = sample_mean(c.logs);
        c.log_mean = mean.value;
        c.scatter = {mean.variance};
        if (c.known == Contender::Known::lower_bounds || !std::isfinite(mean.variance.variance)) continue;
        sum += mean.variance.degrees * mean.variance.variance * static_cast<double>(c.logs.size());
        degrees += mean.variance.degrees;
    }
    for (Contender& c : contenders) {
        if (degrees == 0 || !std::isfinite(c.scatter[0].variance)) continue;
        const VarianceTerm pooled{sum / degrees / static_cast<double>(c.logs.size()), degrees};
        c.scatter[0].variance = std::max(c.scatter[0].variance - pooled.variance, 0.0);
        c.scatter.push_back(pooled);
    }
}

std::vector<VarianceTerm> difference_terms(const Contender& a, const Contender& b) {
    std::vector<VarianceTerm> terms = a.scatter;
    terms.insert(terms.end(), b.scatter.begin(), b.scatter.end());
    if (a.pulls.size() != b.pulls.size() || a.pulls.size() < 2) return terms;
    const auto m = static_cast<double>(a.pulls.size());
    double squares = 0;
    for (std::size_t g = 0; g < a.pulls.size(); ++g)
        squares += sqr(a.pulls[g] - b.pulls[g]);
    terms.push_back({squares / (m * (m - 1)), m - 1});
    return terms;
}

bool differ_significantly(const Contender& better, const Contender& worse) {
    const double shift = std::min(worse.missed_shift - better.missed_shift, 0.0);
    return better.mean < worse.mean &&
           worse.log_mean - better.log_mean + shift > half_width(difference_terms(better, worse), tie_tail);
}

std::vector<Contender> ranked(std::vector<Contender> contenders) {
    set_scatter(contenders);
    const auto key = [](const Contender& c) {
        const double mean = c.logs.empty() ? c.first_image : c.mean;
        return std::tuple(c.logs.empty(), !c.is_complete, !counts(c), std::isnan(mean) ? INFINITY : mean);
    };
    std::ranges::stable_sort(contenders, {}, key);
    const bool has_best = !contenders.empty() && counts(contenders.front());
    for (Contender& c : contenders) {
        if (has_best && &c != &contenders.front()) c.standing = standing_beside(contenders.front(), c);
        else if (!has_best)
            c.standing = c.logs.empty() ? Standing::no_image : c.is_complete ? Standing::open : Standing::incomplete;
    }
    if (has_best) contenders.front().standing = Standing::best;
    return contenders;
}

const Contender* best_of(const std::vector<Contender>& ranking) {
    return !ranking.empty() && ranking.front().standing == Standing::best ? &ranking.front() : nullptr;
}

const Contender& of_method(const std::vector<Contender>& ranking, const std::string& method) {
    return *std::ranges::find(ranking, method, &Contender::method);
}

Doubts doubts_about(const std::string& method, const std::vector<Contender>& ranking) {
    const Contender& own = of_method(ranking, method);
    Doubts doubts{.one_seed = own.logs.size() == 1};
    for (const Contender& c : ranking) {
        if (c.method == method) continue;
        if (c.standing == Standing::open) doubts.open.push_back(c.method);
        if (counts(c) && !differ_significantly(own, c) && !differ_significantly(c, own))
            (c.logs.size() == 1 && !doubts.one_seed ? doubts.lone : doubts.ties).push_back(c.method);
    }
    return doubts;
}

Contest::Contest(const Analysis& analysis, const std::string& scene, Layer layer)
    : analysis_(analysis),
      scene_(scene),
      layer_(layer),
      methods_(cells_by_method(analysis, scene)),
      is_judged_(layer != Layer::total || analysis.unjudged(scene).empty()),
      noise_floor_(std::max(analysis.noise_floor(scene, layer), 0.0)) {}

double Contest::equal_time() const {
    double shortest = std::numeric_limits<double>::infinity(), longest = 0;
    for (const auto& [method, cells] : methods_) {
        const double mean = mean_seconds(cells);
        longest = std::max(longest, mean);
        if (!have_converged(cells)) shortest = std::min(shortest, mean);
    }
    return std::min(shortest, longest);
}

bool Contest::is_complete(const TableRow& row) const {
    return layer_ == Layer::total ? row.is_complete() : !row.components_missing.touches(layer_);
}

double Contest::noise_floor(const std::string& method) const {
    const TableRow* row = analysis_.row(scene_, method, layer_);
    return row ? std::max(row->noise_floor, noise_floor_) : noise_floor_;
}

double Contest::noise_floor() const {
    std::optional<double> least;
    for (const auto& [method, cells] : methods_)
        if (const TableRow* row = analysis_.row(scene_, method, layer_); row && row->statistics && is_complete(*row))
            least = std::min(least.value_or(noise_floor(method)), noise_floor(method));
    return least.value_or(noise_floor_);
}

Contender Contest::contender(const std::string& method, const Runs& cells) const {
    const TableRow* row = analysis_.row(scene_, method, layer_);
    return {.method = method,
            .is_complete = !row || is_complete(*row),
            .pulls = row && row->statistics ? row->statistics->pulls : std::vector<double>(),
            .missed_shift = row && row->statistics ? row->statistics->missed_shift : 0,
            .ended = have_converged(cells) ? std::numeric_limits<double>::infinity() : mean_seconds(cells),
            .first_image = first_image_of_all(cells)};
}

void Contest::set_errors(Contender& contender, const Runs& cells, double seconds) const {
    const auto errors2 = errors2_by(cells, layer_, seconds);
    if (errors2.empty()) return;
    const double mean = sample_mean(errors2).value, floor = noise_floor(contender.method);
    const bool is_resolved = !(mean <= floor);
    contender.mean = is_resolved ? mean : floor;
    for (const double error2 : errors2)
        contender.logs.push_back(std::log(std::max({is_resolved ? error2 : floor, floor, least_error2})));
}

void Contest::extrapolate(Contender& contender, double seconds) const {
    contender.known = Contender::Known::upper_bounds;
    const TableRow* row = analysis_.row(scene_, contender.method, layer_);
    if (!row || !row->law || !law_reaches(*row->law, seconds)) return;
    if (const auto error2 = row->law->error2_after(seconds, row->is_unbiased).interval)
        contender.by_law = Interval{std::log(std::max(error2->lo, 0.0)), std::log(std::max(error2->hi, 0.0))};
}

std::vector<Contender> Contest::after(double seconds) const {
    std::vector<Contender> contenders;
    for (const auto& [method, cells] : methods_) {
        Contender c = contender(method, cells);
        set_errors(c, cells, seconds);
        if (c.ended < (1 - end_slack) * seconds) extrapolate(c, seconds);
        contenders.push_back(std::move(c));
    }
    return ranked(std::move(contenders));
}

std::vector<Contender> Contest::to_error(std::size_t target) const {
    std::vector<Contender> contenders;
    const double error = target_errors[target];
    for (const auto& [method, cells] : methods_) {
        const TableRow* row = analysis_.row(scene_, method, layer_);
        if (!row || !row->statistics) continue;
        Contender c = contender(method, cells);
        for (const auto& curve : error_curves(cells, layer_)) {
            const auto time =
                is_target_resolved(target, noise_floor(method)) ? crossing_time(curve, error) : std::nullopt;
            if (!time) c.known = Contender::Known::lower_bounds;
            c.logs.push_back(std::log(time ? *time : curve.empty() ? 0 : curve.back().seconds));
        }
        c.mean = std::exp(sample_mean(c.logs).value);
        if (c.known == Contender::Known::lower_bounds) {
            const auto error2 = corrected_rel_mse(*row)->interval;
            c.is_close = error2 && error2->lo < sqr(error);
            const Field time = time_field(*row, target);
            constexpr double never = std::numeric_limits<double>::infinity();
            // A method that has converged needs no law: more time would not change its image.
            if (time.state == State::never || have_converged(cells)) c.by_law = Interval{never, never};
            if (time.state == State::at_least) c.by_law = Interval{std::log(time.value), never};
            if (time.state == State::extrapolated)
                c.by_law = Interval{std::log(time.interval->lo), std::log(time.interval->hi)};
        }
        contenders.push_back(std::move(c));
    }
    return ranked(std::move(contenders));
}

std::vector<Contender> Contest::by_final_images() const {
    std::vector<Contender> contenders;
    for (const auto& [method, cells] : methods_) {
        Contender c = contender(method, cells);
        set_errors(c, cells, std::numeric_limits<double>::infinity());
        contenders.push_back(std::move(c));
    }
    contenders = ranked(std::move(contenders));
    const Contender* best = best_of(contenders);
    if (!best) return contenders;
    const double seconds = mean_seconds(methods_.at(best->method));
    for (Contender& c : contenders)
        if (&c != best && c.ended < (1 - end_slack) * seconds) extrapolate(c, seconds);
    return ranked(std::move(contenders));
}

}  // namespace gib
