#include "experiments/references/reference_methods.h"

#include "experiments/metrics/epsilon.h"
#include "experiments/references/agreement.h"
#include "experiments/references/group_moments.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>

namespace gib {

namespace {

constexpr double least_share_of_work = 0.01;  ///< a method of less is left out
constexpr double second_opinion = 0.1;        ///< share of the work of the second method, at least
/// Significance level at which a method lacks light that another one has found. A false alarm costs time and no bias.
constexpr double lacking_alpha = 0.001;
constexpr double least_weight = 0.1;  ///< a method of less weight makes none of a component
/// The best method does the work, except the second opinion, unless all together are predicted to be faster by more
/// than this factor: a method with all the work makes more passes in a row.
constexpr double least_gain = 1.1;
/// The variance of a pass is foreseen to fall with the number of passes to the power of minus this at most, and up to
/// so many times the passes of the pilot: by 8 in all. The lamp's edges in cornell-box.xml fall by 20 from 16 to 1024
/// passes, direct light by 1.4.
constexpr double steepest_gain = 0.5, farthest_gain = 64;
/// A fall that the noise of fewer pixels decides is not foreseen to go on.
constexpr double fewest_pixels = 8;
/// The costs that a pilot shows may be so many times the true ones: rare bright paths make them uncertain, and methods
/// that learn have not learned yet.
constexpr double outdone_by = 2;

/// Variance times work, V_cm, of every component and method; infinite where the method cannot sample the component, or
/// lacks light in it significantly and another one does not.
class Costs {
public:
    Costs(const std::vector<MethodPilot>& pilots, const std::optional<double>& epsilon, double work)
        : pilots_(pilots), work_(work) {
        std::vector<std::vector<ComponentImages>> blocks(pilots.size());
        for (std::size_t m = 0; m < pilots.size(); ++m)
            for (const ComponentImages& group : pilots[m].groups)
                blocks[m].push_back(block_means(group));
        set_denominators(blocks, epsilon);
        for (Component c : all_components)
            if (pilots.front().groups.front()[c]) measure(c, blocks);
    }

    /// Whether some method has found light of the component.
    bool is_lit(Component c) const {
        const auto has_light = [&](const ComponentImages& group) { return group[c] && !is_black(*group[c]); };
        return std::ranges::any_of(
            pilots_, [&](const MethodPilot& pilot) { return std::ranges::any_of(pilot.groups, has_light); });
    }
    const std::vector<double>& of(Component c) const { return costs_[static_cast<std::size_t>(index_of(c))]; }
    double work_of_pass(std::size_t m) const {
        return pilots_[m].work / (static_cast<double>(pilots_[m].groups.size()) * pilots_[m].passes);
    }

private:
    bool samples(std::size_t m, Component c) const { return !contains(pilots_[m].unresolved, c); }

    /// r^2 + epsilon of the error's definition, by block: r is the mean of the methods' total light.
    void set_denominators(const std::vector<std::vector<ComponentImages>>& blocks, const std::optional<double>& given) {
        std::vector<double> total;
        for (Component c : all_components) {
            double methods = 0;
            std::vector<double> sum;
            for (std::size_t m = 0; m < blocks.size(); ++m) {
                if (!blocks[m].front()[c] || !samples(m, c)) continue;
                const std::vector<double> mean = moments_of(blocks[m], c).mean;
                sum.resize(mean.size());
                for (std::size_t i = 0; i < mean.size(); ++i)
                    sum[i] += mean[i];
                ++methods;
            }
            total.resize(std::max(total.size(), sum.size()));
            for (std::size_t i = 0; i < sum.size(); ++i)
                total[i] += sum[i] / methods;
        }
        Image mean(blocks.front().front().width, blocks.front().front().height);
        std::ranges::transform(total, mean.rgb.begin(), [](double r) { return static_cast<float>(r); });
        const double epsilon = epsilon_of(given, mean);
        for (const double r : total)
            denominators_.push_back(r * r + epsilon);
    }

    void measure(Component c, const std::vector<std::vector<ComponentImages>>& blocks) {
        std::vector<GroupMoments> of_blocks;
        for (const auto& groups : blocks)
            of_blocks.push_back(moments_of(groups, c));
        std::vector<double>& costs = costs_[static_cast<std::size_t>(index_of(c))];
        for (std::size_t m = 0; m < pilots_.size(); ++m) {
            if (!samples(m, c)) {
                costs.push_back(std::numeric_limits<double>::infinity());
                continue;
            }
            double variance = mean_of(pixel_variances(pilots_[m].groups, c)) * gain_of_points(m, c), lacking = 0;
            for (std::size_t other = 0; other < pilots_.size(); ++other)
                if (samples(other, c)) lacking = std::max(lacking, shortfall(of_blocks[m], of_blocks[other]));
            // Both are of the mean over all passes; the variance of one pass is that times their number.
            const double passes = static_cast<double>(pilots_[m].groups.size()) * pilots_[m].passes;
            costs.push_back((variance + lacking) * passes * work_of_pass(m));
        }
        leave_out_lacking(c, blocks, costs);
    }

    /// Makes the costs of methods that lack light infinite, unless no other would remain.
    void leave_out_lacking(Component c, const std::vector<std::vector<ComponentImages>>& blocks,
                           std::vector<double>& costs) const {
        std::vector<double> left = costs;
        for (std::size_t a = 0; a < pilots_.size(); ++a)
            for (std::size_t b = 0; b < a; ++b) {
                if (!samples(a, c) || !samples(b, c)) continue;
                if (const auto block = disagreement(blocks[a], blocks[b], c, lacking_alpha, Differing::either_way))
                    left[block->deviation < 0 ? a : b] = std::numeric_limits<double>::infinity();
            }
        if (std::ranges::any_of(left, [](double cost) { return std::isfinite(cost); })) costs = left;
    }

    /// The relative variance of the mean over all groups, by pixel and channel.
    std::vector<double> pixel_variances(const std::vector<ComponentImages>& groups, Component c) const {
        std::vector<double> variances = moments_of(groups, c).variance;
        const Image& image = *groups.front()[c];
        const Grid grid = Grid::with_edge(image.width, image.height, agreement_edge);
        for (std::size_t b = 0; b < grid.size(); ++b)
            grid.for_each_in(b, [&](int x, int y) {
                const auto pixel =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x);
                for (std::size_t k = 0; k < 3; ++k)
                    variances[3 * pixel + k] /= denominators_[3 * b + k];
            });
        return variances;
    }

    /// The factor by which the variance of a pass of method m is foreseen to be smaller in the reference than in the
    /// pilot's last round. With the sum S of the pixels' variances of a pass in the first round and in the last,
    /// log(S_last / S_first) has the variance sum over pixels of (s_last / S_last - s_first / S_first)^2, where pixels
    /// are independent and none outweighs the others. Only the fall beyond two standard errors counts, and none where a
    /// few bright pixels decide.
    double gain_of_points(std::size_t m, Component c) const {
        const MethodPilot& pilot = pilots_[m];
        const double batch = work_ / (reference_groups * work_of_pass(m));  // passes, if m made all of the reference
        const double more = std::min(batch / pilot.passes, farthest_gain);
        if (pilot.first_groups.empty() || !(more > 1)) return 1;
        const std::vector<double> first = pixel_variances(pilot.first_groups, c),
                                  last = pixel_variances(pilot.groups, c);
        const double of_first = sum_of(first), of_last = sum_of(last);
        if (!(of_first > 0 && of_last > 0)) return 1;
        double variance = 0;
        for (std::size_t i = 0; i < last.size(); i += 3) {
            double difference = 0;  // the channels of a pixel are one sample
            for (std::size_t k = i; k < i + 3; ++k)
                difference += last[k] / of_last - first[k] / of_first;
            variance += sqr(difference);
        }
        if (variance > 1.0 / fewest_pixels) return 1;
        const double rise = static_cast<double>(pilot.passes) / pilot.first_passes;
        const double fall = -(std::log(rise * of_last / of_first) + 2 * std::sqrt(variance)) / std::log(rise);
        return std::pow(more, -std::clamp(fall, 0.0, steepest_gain));
    }

    /// Mean over blocks of the squared light that the other method has found and this one has not, beyond their noise.
    double shortfall(const GroupMoments& own, const GroupMoments& other) const {
        double sum = 0;
        for (std::size_t i = 0; i < own.mean.size(); ++i) {
            const double lacking = std::max(other.mean[i] - own.mean[i], 0.0);
            sum += (lacking * lacking - own.variance[i] - other.variance[i]) / denominators_[i];
        }
        return std::max(sum / static_cast<double>(own.mean.size()), 0.0);
    }

    const std::vector<MethodPilot>& pilots_;
    double work_;
    std::vector<double> denominators_;
    std::array<std::vector<double>, component_count> costs_;
};

/// The shares of work that minimise the sum over components of 1 / sum over m of (t_m / V_cm), by fixed-point steps
/// t_m <- t_m sqrt(g_m) / sum, with the gain g_m of more work for m. They keep the shares positive and lower the sum.
std::vector<double> shares_of_work(const std::vector<std::vector<double>>& costs, std::size_t methods) {
    std::vector<double> shares(methods, 1.0 / static_cast<double>(methods));
    for (int step = 0; step < 2000; ++step) {
        std::vector<double> gains(methods, 0);
        for (const auto& of_component : costs) {
            double precision = 0;
            for (std::size_t m = 0; m < methods; ++m)
                precision += shares[m] / of_component[m];
            for (std::size_t m = 0; m < methods; ++m)
                gains[m] += 1 / (of_component[m] * precision * precision);
        }
        double sum = 0;
        for (std::size_t m = 0; m < methods; ++m)
            sum += shares[m] *= std::sqrt(gains[m]);
        if (!(sum > 0)) return std::vector<double>(methods, 1.0 / static_cast<double>(methods));
        for (double& share : shares)
            share /= sum;
    }
    return shares;
}

/// The costs that decide the shares: of the components that some method samples and whose pilot has shown noise.
std::vector<std::vector<double>> judged_costs(const Costs& costs) {
    std::vector<std::vector<double>> judged;
    for (Component c : all_components) {
        std::vector<double> of_component = costs.of(c);
        double largest = 0;
        for (const double cost : of_component)
            if (std::isfinite(cost)) largest = std::max(largest, cost);
        if (!(largest > 0)) continue;
        for (double& cost : of_component)
            cost = std::max(cost, 1e-9 * largest);  // a component may have no noise at all
        judged.push_back(of_component);
    }
    return judged;
}

/// Whole numbers of passes of a unit, in about the proportions of these shares of work.
std::vector<std::uint32_t> passes_of_unit(const std::vector<double>& work, const Costs& costs) {
    std::vector<double> rates;  // passes in a unit of the reference's work
    double least = std::numeric_limits<double>::infinity(), most = 0;
    for (std::size_t m = 0; m < work.size(); ++m) {
        rates.push_back(work[m] < least_share_of_work ? 0 : work[m] / costs.work_of_pass(m));
        if (rates[m] > 0) least = std::min(least, rates[m]);
        most = std::max(most, rates[m]);
    }
    const double scale = (most < 2 * least ? 2 : 1) / least;
    std::vector<std::uint32_t> passes;
    for (const double rate : rates)
        passes.push_back(static_cast<std::uint32_t>(std::round(std::min(rate * scale, 1e6))));
    return passes;
}

/// Sets the weights of component c and returns the precision of the shares' sum, 1 / variance. Where no method samples
/// the component, or it is black so far, the busiest one makes it, and the result is 0.
double weigh(Component c, const Costs& costs, std::vector<MethodShare>& shares) {
    double precision = 0, busiest = 0;
    std::size_t first = 0;
    for (std::size_t m = 0; m < shares.size(); ++m) {
        const double work = shares[m].passes * costs.work_of_pass(m);
        shares[m].weight(c) = work / std::max(costs.of(c)[m], 1e-200);
        precision += shares[m].weight(c);
        if (work > busiest) {
            busiest = work;
            first = m;
        }
    }
    const bool is_judged = precision > 0 && std::isfinite(precision);
    double kept = 0;
    for (MethodShare& share : shares) {
        double& weight = share.weight(c);
        if (weight < least_weight * precision) weight = 0;
        kept += weight;
    }
    for (std::size_t m = 0; m < shares.size(); ++m) {
        double& weight = shares[m].weight(c);
        weight = is_judged ? weight / kept : m == first ? 1 : 0;
    }
    return is_judged ? kept : 0;
}

/// The sum over components of the costs of method m. With `known`, infinite costs count ten times the largest finite
/// one of the component.
double sum_of_costs(const std::vector<std::vector<double>>& judged, std::size_t m, bool known) {
    double sum = 0;
    for (const auto& of_component : judged) {
        double largest = 0;
        for (const double cost : of_component)
            if (std::isfinite(cost)) largest = std::max(largest, cost);
        sum += known && !std::isfinite(of_component[m]) ? 10 * largest : of_component[m];
    }
    return sum;
}

/// The product of squared error and work: 1 / sum over m of (t_m / V_cm), summed over components.
double error2_work(const std::vector<std::vector<double>>& judged, const std::vector<double>& work) {
    double sum = 0;
    for (const auto& of_component : judged) {
        double precision = 0;
        for (std::size_t m = 0; m < work.size(); ++m)
            precision += work[m] / of_component[m];
        sum += 1 / precision;
    }
    return sum;
}

/// The method other than `first` with the least costs.
std::size_t second_method(const std::vector<std::vector<double>>& judged, std::size_t methods, std::size_t first) {
    std::size_t second = first == 0 ? 1 : 0;
    for (std::size_t m = 0; m < methods; ++m)
        if (m != first && sum_of_costs(judged, m, true) < sum_of_costs(judged, second, true)) second = m;
    return second;
}

/// Gives each needed method a tenth of the work at least: the best of a component that no busy method makes, and a
/// second opinion.
void add_needed_methods(const Costs& costs, const std::vector<std::vector<double>>& judged, std::vector<double>& work) {
    std::vector<bool> needed(work.size());
    for (Component c : all_components) {
        const std::vector<double>& of_component = costs.of(c);
        if (of_component.empty() || !costs.is_lit(c)) continue;
        bool is_made = false;
        for (std::size_t m = 0; m < work.size(); ++m)
            is_made = is_made || (std::isfinite(of_component[m]) && (needed[m] || work[m] >= least_share_of_work));
        const auto best = std::ranges::min_element(of_component);
        if (!is_made && std::isfinite(*best)) needed[static_cast<std::size_t>(best - of_component.begin())] = true;
    }
    const auto first = static_cast<std::size_t>(std::ranges::max_element(work) - work.begin());
    const auto is_busy = [&](std::size_t m) { return m != first && (needed[m] || work[m] >= second_opinion); };
    bool has_second = false;
    for (std::size_t m = 0; m < work.size(); ++m)
        has_second = has_second || is_busy(m);
    if (!has_second && work.size() > 1) needed[second_method(judged, work.size(), first)] = true;
    double sum = 0;
    for (std::size_t m = 0; m < work.size(); ++m) {
        if (needed[m]) work[m] = std::max(work[m], second_opinion / (1 - second_opinion) * work[first]);
        sum += work[m];
    }
    for (double& share : work)
        share /= sum;
}

/// ReferencePlan::outdone.
std::vector<bool> outdone_methods(const std::vector<std::vector<double>>& judged, std::size_t methods) {
    std::vector<bool> outdone(methods, false);
    if (judged.empty()) return outdone;
    std::size_t best = 0;
    for (std::size_t m = 0; m < methods; ++m) {
        if (sum_of_costs(judged, m, true) < sum_of_costs(judged, best, true)) best = m;
        std::vector<std::vector<double>> cheaper = judged;
        for (auto& of_component : cheaper)
            of_component[m] /= outdone_by;
        outdone[m] = shares_of_work(cheaper, methods)[m] < least_share_of_work;
    }
    outdone[best] = false;
    if (methods > 1) outdone[second_method(judged, methods, best)] = false;
    return outdone;
}

/// The method with its settings, which goes on after so many passes if it depends on them.
std::unique_ptr<Method> method_after(const MethodDescription& method, const MethodLabel& label, int max_edges,
                                     std::uint64_t passes) {
    return method.create(ParameterValues(all_parameters(method), label), {max_edges, passes});
}

/// Adds the weighted image, if there is one, to the sum, which begins with the first.
void add_weighted(std::optional<Image>& sum, const std::optional<Image>& image, double weight) {
    if (!image) return;
    if (!sum) sum = Image(image->width, image->height);
    for (std::size_t i = 0; i < sum->rgb.size(); ++i)
        sum->rgb[i] += static_cast<float>(weight * double{image->rgb[i]});
}

}  // namespace

ReferenceMethod::ReferenceMethod(const MethodDescription& method, const MethodLabel& label, const LoadedScene& scene,
                                 bool takes_remainder)
    : scene_(scene), method_(method), label_{method.name, label.values}, name_(method.name) {
    unresolved_ = method_after(method_, label_, scene.max_edges, 0)->plan(*scene.scene).unresolved;
    if (unresolved_.empty() || !takes_remainder) return;
    for (const MethodDescription& other : method_registry()) {
        if (other.remainder.of_method != method.name) continue;
        remainder_ = &other;
        remainder_label_ = MethodLabel::parse(other.name + " " + other.remainder.values);
        remainder_label_.values.insert(remainder_label_.values.end(), label.values.begin(), label.values.end());
        name_ += "+" + other.name;
        unresolved_.clear();
    }
}

MadeBatch ReferenceMethod::make(std::uint64_t seed, std::uint32_t passes, std::uint64_t passes_before,
                                const std::function<void()>& before_pass) const {
    MadeBatch made = make(method_, label_, seed, passes, passes_before, before_pass);
    if (!remainder_) return made;
    const MadeBatch rest = make(*remainder_, remainder_label_, seed, passes, passes_before, before_pass);
    for (std::size_t c = 0; c < component_count; ++c) {
        add_weighted(made.images.parts[c], rest.images.parts[c], 1);
        add_weighted(made.images.bias[c], rest.images.bias[c], 1);
    }
    made.dropped.add(rest.dropped);
    made.work += rest.work;
    made.seconds += rest.seconds;
    return made;
}

MadeBatch ReferenceMethod::make(const MethodDescription& method, const MethodLabel& label, std::uint64_t seed,
                                std::uint32_t passes, std::uint64_t passes_before,
                                const std::function<void()>& before_pass) const {
    const auto begin = std::chrono::steady_clock::now();
    StageTimes stages;
    const auto run = method_after(method, label, scene_.max_edges, passes_before)->start(*scene_.scene, seed, stages);
    for (std::uint32_t pass = 0; pass < passes; ++pass) {
        before_pass();
        if (run->advance(pass) == Progress::converged) break;
    }
    MadeBatch made{.images = run->image()};
    const RunCounts counts = run->counts();
    if (const NonFinite& bad = counts.non_finite; bad.count > 0)
        made.dropped = {bad.count, fmt::format("seed {}, pass {}, pixel {}", seed, bad.first_pass, bad.first_pixel)};
    const double samples = static_cast<double>(made.images.width) * made.images.height * passes;
    made.work = method.ray_cost * (static_cast<double>(counts.rays) + samples);
    made.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return made;
}

ReferencePlan plan_of_least_variance(const std::vector<std::string>& methods, const std::vector<MethodPilot>& pilots,
                                     const std::optional<double>& epsilon, double work_of_reference) {
    const Costs costs(pilots, epsilon, work_of_reference);
    const std::vector<std::vector<double>> judged = judged_costs(costs);
    std::vector<double> work = shares_of_work(judged, methods.size());
    add_needed_methods(costs, judged, work);
    std::vector<double> alone;  // infinite for a method that cannot make everything
    for (std::size_t m = 0; m < methods.size(); ++m)
        alone.push_back(sum_of_costs(judged, m, false));
    const auto best = std::ranges::min_element(alone);
    if (!judged.empty() && std::isfinite(*best)) {
        std::vector<double> few(methods.size(), 0);
        few[static_cast<std::size_t>(best - alone.begin())] = 1;
        add_needed_methods(costs, judged, few);
        if (error2_work(judged, few) <= least_gain * error2_work(judged, work)) work = few;
    }
    const std::vector<std::uint32_t> passes = passes_of_unit(work, costs);
    ReferencePlan plan;
    plan.outdone = outdone_methods(judged, methods.size());
    for (std::size_t m = 0; m < methods.size(); ++m) {
        plan.shares.push_back({methods[m], passes[m], {}});
        plan.unit_work += passes[m] * costs.work_of_pass(m);
    }
    for (Component c : all_components) {
        if (costs.of(c).empty()) continue;
        const double precision = weigh(c, costs, plan.shares);
        if (precision > 0) plan.error2_work += plan.unit_work / precision;
    }
    return plan;
}

void leave_to_others(std::vector<MethodShare>& shares, Component c, std::size_t lesser, std::size_t greater) {
    shares[lesser].weight(c) = 0;
    double left = 0;
    for (MethodShare& share : shares)
        left += share.weight(c);
    if (!(left > 0)) left = shares[greater].weight(c) = 1;
    for (MethodShare& share : shares) {
        share.weight(c) /= left;
        if (share.weight(c) > 0) share.passes = std::max(share.passes, shares[lesser].passes);
    }
}

std::string text_of(const std::vector<MethodShare>& shares) {
    std::string text;
    for (const MethodShare& share : shares) {
        text += fmt::format("{}{} {}", text.empty() ? "" : "; ", share.method, share.passes);
        for (const double weight : share.weights)
            text += fmt::format(" {:.17g}", weight);
    }
    return text;
}

std::vector<MethodShare> shares_in(const std::string& text) {
    std::vector<MethodShare> shares;
    std::istringstream parts(text);
    for (std::string part; std::getline(parts, part, ';');) {
        std::istringstream words(part);
        MethodShare share;
        words >> share.method >> share.passes;
        for (double& weight : share.weights)
            words >> weight;
        if (!words) return {};
        shares.push_back(share);
    }
    return shares;
}

std::uint64_t passes_in(const std::vector<MethodShare>& shares, std::uint64_t units) {
    std::uint64_t passes = 0;
    for (const MethodShare& share : shares)
        passes += share.passes;
    return units * std::max<std::uint64_t>(passes, 1);
}

ComponentImages combined(const std::vector<MethodShare>& shares, const std::vector<ComponentImages>& images) {
    ComponentImages sum;
    for (std::size_t m = 0; m < shares.size(); ++m) {
        if (shares[m].passes == 0) continue;
        sum.width = images[m].width;
        sum.height = images[m].height;
        for (std::size_t c = 0; c < component_count; ++c) {
            add_weighted(sum.parts[c], images[m].parts[c], shares[m].weights[c]);
            add_weighted(sum.bias[c], images[m].bias[c], shares[m].weights[c]);
        }
    }
    return sum;
}

}  // namespace gib
