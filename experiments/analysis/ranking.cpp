#include "experiments/analysis/ranking.h"

#include "experiments/metrics/student_t.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace gib {

namespace {

bool counts(const Contender& c) { return c.is_complete && !c.values.empty() && c.known == Contender::Known::equal; }

/// The upper end of the interval of a mean; infinite for one value.
double upper_end(const std::vector<double>& values) {
    const SampleMean mean = sample_mean(values);
    const double half = values.size() > 1 ? half_width({mean.variance}, tie_tail) : NAN;
    return std::isfinite(half) ? mean.value + half : std::numeric_limits<double>::infinity();
}

Standing standing_beside(const Contender& best, const Contender& c) {
    if (c.values.empty()) return Standing::no_image;
    if (!c.is_complete) return Standing::incomplete;
    if (c.known == Contender::Known::equal)
        return are_told_apart(best.values, c.values) ? Standing::behind : Standing::tie;
    const bool behind_by_law = c.by_law && c.by_law->lo > upper_end(best.values);
    const bool behind_by_bounds = c.known == Contender::Known::lower_bounds && are_told_apart(best.values, c.values);
    return behind_by_law || behind_by_bounds ? Standing::behind : Standing::open;
}

}  // namespace

double Contender::mean() const { return sample_mean(values).value; }

bool are_told_apart(const std::vector<double>& better, const std::vector<double>& worse) {
    if (better.size() < 2 || worse.size() < 2) return false;
    const SampleMean a = sample_mean(better), b = sample_mean(worse);
    return b.value - a.value > half_width({a.variance, b.variance}, tie_tail);
}

std::vector<Contender> ranked(std::vector<Contender> contenders) {
    const auto key = [](const Contender& c) {
        const double mean = c.values.empty() ? c.first_image : c.mean();
        return std::tuple(c.values.empty(), !c.is_complete, !counts(c), std::isnan(mean) ? INFINITY : mean);
    };
    std::stable_sort(contenders.begin(), contenders.end(),
                     [&](const Contender& a, const Contender& b) { return key(a) < key(b); });
    const bool has_best = !contenders.empty() && counts(contenders.front());
    for (Contender& c : contenders) {
        if (has_best && &c != &contenders.front()) c.standing = standing_beside(contenders.front(), c);
        else if (!has_best)
            c.standing = c.values.empty() ? Standing::no_image : c.is_complete ? Standing::open : Standing::incomplete;
    }
    if (has_best) contenders.front().standing = Standing::best;
    return contenders;
}

const Contender* best_of(const std::vector<Contender>& ranking) {
    return !ranking.empty() && ranking.front().standing == Standing::best ? &ranking.front() : nullptr;
}

std::vector<std::string> those(const std::vector<Contender>& ranking, Standing standing) {
    std::vector<std::string> methods;
    for (const Contender& c : ranking)
        if (c.standing == standing) methods.push_back(c.method);
    return methods;
}

}  // namespace gib
