#include "experiments/analysis/ranking.h"

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
    if (c.known == Contender::Known::equal) return are_told_apart(best, c) ? Standing::behind : Standing::tie;
    const bool behind_by_law = c.by_law && c.by_law->lo > upper_end(best);
    const bool behind_by_bounds = c.known == Contender::Known::lower_bounds && are_told_apart(best, c);
    return behind_by_law || behind_by_bounds ? Standing::behind : Standing::open;
}

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

bool are_told_apart(const Contender& better, const Contender& worse) {
    std::vector<VarianceTerm> terms = better.scatter;
    terms.insert(terms.end(), worse.scatter.begin(), worse.scatter.end());
    return better.mean < worse.mean && worse.log_mean - better.log_mean > half_width(terms, tie_tail);
}

std::vector<Contender> ranked(std::vector<Contender> contenders) {
    set_scatter(contenders);
    const auto key = [](const Contender& c) {
        const double mean = c.logs.empty() ? c.first_image : c.mean;
        return std::tuple(c.logs.empty(), !c.is_complete, !counts(c), std::isnan(mean) ? INFINITY : mean);
    };
    std::ranges::stable_sort(contenders, [&](const Contender& a, const Contender& b) { return key(a) < key(b); });
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
    return *std::ranges::find_if(ranking, [&](const auto& c) { return c.method == method; });
}

Doubts doubts_about(const std::string& method, const std::vector<Contender>& ranking) {
    const Contender& own = of_method(ranking, method);
    Doubts doubts{.one_seed = own.logs.size() == 1};
    for (const Contender& c : ranking) {
        if (c.method == method) continue;
        if (c.standing == Standing::open) doubts.open.push_back(c.method);
        if (counts(c) && !are_told_apart(own, c) && !are_told_apart(c, own)) doubts.ties.push_back(c.method);
    }
    return doubts;
}

}  // namespace gib
