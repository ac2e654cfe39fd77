#include "experiments/report/words.h"

#include "common/core/math.h"
#include "experiments/analysis/row_fields.h"
#include "experiments/plan/label_checks.h"
#include "experiments/text/numbers.h"
#include "methods/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace gib {

namespace {

std::string whole_percent(double share) {
    const double value = 100 * share;
    return value > 0 && value < 1 ? fmt::format("{:.1g}", value) : fmt::format("{:.0f}", value);
}

std::string number_text(double value, Unit unit) {
    if (std::isnan(value)) return "nan";
    switch (unit) {
        case Unit::percent:
            return percent_text(value);
        case Unit::root:
            return percent_text(std::sqrt(at_least_zero(value)));
        case Unit::whole:
            return fmt::format("{:.0f}", value);
        case Unit::share:
            return whole_percent(value);
        case Unit::number:
            break;
    }
    return short_number(value);
}

/// "`a`, `b` and 3 more"
std::string named(const std::vector<std::string>& methods) {
    constexpr std::size_t most = 3;
    std::string text;
    for (std::size_t i = 0; i < std::min(most, methods.size()); ++i)
        text += fmt::format("{}`{}`", i > 0 ? ", " : "", methods[i]);
    return methods.size() > most ? fmt::format("{} and {} more", text, methods.size() - most) : text;
}

Field error_of(const Contender& c, const TableRow& total) {
    if (c.logs.empty()) return {State::no_image, c.first_image};
    return total.statistics ? resolved({c.mean, {}}, total.noise_floor) : Field{State::no_verdict};
}

/// The layers whose mean energy differs from the reference's, "total, caustic".
std::string different_energy(const Analysis& analysis, const EqualTimeLook& look) {
    std::string names;
    for (const TableRow& row : analysis.rows)
        if (row.scene == look.scene && row.method == look.method && row.has_verdict(BalanceVerdict::differs))
            names += (names.empty() ? "" : ", ") + std::string(name_of(row.layer));
    return names;
}

std::string beside_text(const std::vector<Contender>& ranking, const Contender& c) {
    switch (c.standing) {
        case Standing::best: {
            const std::string doubt = doubts(ranking);
            return doubt.empty() ? "best" : "best, " + doubt;
        }
        case Standing::tie:
            return "not significantly different from the best";
        case Standing::one_seed:
            return "inconclusive: one seed";
        case Standing::open:
            return "not run longer";
        case Standing::incomplete:
            return "leaves out light";
        default:
            return "";
    }
}

/// A time as multiples of another one, as far as it is known. The interval of the time alone is not that of the ratio.
Field times_as_much(Field time, double factor) {
    const bool is_number =
        time.state == State::measured || time.state == State::at_least || time.state == State::extrapolated;
    if (!is_number) return {};
    time.value *= factor;
    if (time.state == State::extrapolated && time.interval)
        time.interval = Interval{time.interval->lo * factor, time.interval->hi * factor};
    else time.interval.reset();
    return time;
}

std::optional<double> mean_error2(const Runs& cells, Layer layer, double seconds) {
    const auto errors2 = errors2_by(cells, layer, seconds);
    return errors2.empty() ? std::nullopt : std::optional(sample_mean(errors2).value);
}

/// The answers of one scene.
class Answers {
public:
    Answers(const Analysis& analysis, std::string scene)
        : analysis_(analysis), scene_(std::move(scene)), contest_(analysis, scene_) {}

    std::vector<VerdictRow> verdict() const {
        if (contest_.methods() == 0) return {};
        if (!contest_.is_judged())
            return {VerdictRow{.remark = fmt::format("the reference is incomplete or contradicted in {}",
                                                     words_of(analysis_.unjudged(scene_)))}};
        std::vector<VerdictRow> rows;
        for (const std::size_t target : asked_targets) {
            const auto ranking = contest_.to_error(target);
            const auto of_target = best_of(ranking) ? with_winner(ranking, target) : without_winner(target);
            rows.insert(rows.end(), of_target.begin(), of_target.end());
        }
        return rows;
    }

private:
    const TableRow& row(const std::string& method) const { return *analysis_.row(scene_, method, Layer::total); }

    /// The components' shares of the sum of their squared errors after `seconds`, largest first, without those below
    /// half a percent: "90 % caustic, 10 % indirect"; empty if there is none.
    std::string parts_of_error(const Runs& cells, double seconds) const {
        double sum = 0;
        std::vector<std::pair<double, Layer>> parts;
        for (const Layer layer : layers_of(analysis_, scene_)) {
            const auto error2 = mean_error2(cells, layer, seconds);
            if (layer == Layer::total || !error2 || !(*error2 > 0)) continue;
            sum += *error2;
            parts.emplace_back(*error2, layer);
        }
        std::ranges::stable_sort(parts, [](const auto& a, const auto& b) { return a.first > b.first; });
        std::string text;
        for (const auto& [error2, layer] : parts)
            if (error2 >= 0.005 * sum)
                text += fmt::format("{}{:.0f} % {}", text.empty() ? "" : ", ", 100 * error2 / sum, name_of(layer));
        return text;
    }

    /// A method with its error after `seconds` (if infinite: that of its final images, as in the table of errors).
    VerdictRow row_of(const std::string& method, std::size_t target, double seconds) const {
        const Runs& cells = contest_.cells().at(method);
        const TableRow& of = row(method);
        const auto error2 = mean_error2(cells, Layer::total, seconds);
        std::string remark = left_out(of).empty() ? "" : "leaves out " + left_out(of);
        if (of.seconds < seconds && std::isfinite(seconds) && !have_converged(cells))
            remark += std::string(remark.empty() ? "" : "; ") + "not run longer";
        return {.target = target,
                .method = method,
                .seconds = time_field(of, target),
                .error = error2 ? resolved({*error2, {}}, contest_.noise_floor())
                                : Field{State::no_image, first_image_of_all(cells)},
                .parts = parts_of_error(cells, seconds),
                .kind = error_kind(of),
                .remark = std::move(remark)};
    }

    /// The first label of each method name other than the first one's.
    std::vector<std::string> best_of_other_names(const std::vector<std::string>& methods) const {
        std::set<std::string> named = {name_in(methods.front())};
        std::vector<std::string> best;
        for (const std::string& method : methods)
            if (analysis_.row(scene_, method, Layer::total) && named.insert(name_in(method)).second)
                best.push_back(method);
        return best;
    }
    /// The name that the experiment file gives to a label and its other settings, else the label's method with its
    /// filter.
    std::string name_in(const std::string& method) const {
        const std::string& label = analysis_.label_of(method);
        const auto given = analysis_.index.given_names.find(label);
        if (given != analysis_.index.given_names.end()) return given->second;
        const MethodLabel parsed = MethodLabel::parse(label);
        return parsed.name + " " + filter_of(parsed);
    }
    /// The methods with an image, by the mean error or time, whether or not their runs were long enough to be ranked.
    static std::vector<std::string> by_mean(std::vector<Contender> contenders) {
        std::ranges::stable_sort(contenders, {}, [](const Contender& c) { return std::pair(c.logs.empty(), c.mean); });
        std::vector<std::string> methods;
        for (const Contender& c : contenders)
            methods.push_back(c.method);
        return methods;
    }

    std::vector<VerdictRow> with_winner(const std::vector<Contender>& ranking, std::size_t target) const {
        const Contender& best = ranking.front();
        const double seconds = row(best.method).times[target]->value;
        std::vector<std::string> methods;
        for (const Contender& c : ranking)
            if (c.known == Contender::Known::equal) methods.push_back(c.method);
        for (const std::string& method : by_mean(contest_.after(seconds)))
            methods.push_back(method);
        std::vector<std::string> shown = best_of_other_names(methods);
        if (ranking.size() > 1 && ranking[1].is_complete && ranking[1].known == Contender::Known::equal &&
            std::ranges::find(shown, ranking[1].method) == shown.end())
            shown.insert(shown.begin(), ranking[1].method);

        std::vector<VerdictRow> rows = {row_of(best.method, target, seconds)};
        const Doubts of_best = doubts_about(best.method, ranking);
        rows[0].is_best = true;
        rows[0].is_tie = !of_best.ties.empty() && !of_best.one_seed;
        // The seeds' first images may come after the mean of the times at which each has reached the error.
        if (rows[0].error.state == State::no_image) rows[0].error = measured(sqr(target_errors[target]), Unit::root);
        rows[0].factor = measured(1);
        rows[0].remark = ranking.size() == 1    ? ""
                         : of_best.open.empty() ? "cheapest"
                                                : "first that was seen to reach it";
        rows[0].doubts = doubts(ranking);
        if (!rows[0].doubts.empty()) rows[0].remark += ", " + rows[0].doubts;
        for (const std::string& method : shown) {
            VerdictRow& other = rows.emplace_back(row_of(method, target, seconds));
            other.factor = times_as_much(other.seconds, 1 / seconds);
            const bool is_tie = std::ranges::any_of(
                ranking, [&](const Contender& c) { return c.method == method && c.standing == Standing::tie; });
            if (is_tie) other.remark = "not significantly different from the best", other.is_tie = true;
        }
        return rows;
    }

    std::vector<VerdictRow> without_winner(std::size_t target) const {
        if (!is_target_resolved(target, contest_.noise_floor()))
            return {{.target = target,
                     .remark = fmt::format("the reference's noise hides errors below {} %",
                                           percent_text(std::sqrt(contest_.noise_floor())))}};
        const auto closest = contest_.by_final_images();
        const std::string& closest_method = closest.front().method;
        if (const TableRow* first = analysis_.row(scene_, closest_method, Layer::total); !first || !first->statistics)
            return {};
        std::vector<std::string> methods = {closest_method};
        for (const std::string& method : by_mean(closest))
            methods.push_back(method);
        std::vector<VerdictRow> rows = {row_of(methods.front(), target, INFINITY)};
        const std::string& doubt = rows[0].doubts = doubts(closest);
        const std::string left = rows[0].remark;
        rows[0].remark = "closest" + (doubt.empty() ? "" : ", " + doubt) + (left.empty() ? "" : "; " + left);
        for (const std::string& method : best_of_other_names(methods))
            rows.push_back(row_of(method, target, INFINITY));
        return rows;
    }

    const Analysis& analysis_;
    std::string scene_;
    Contest contest_;
};

}  // namespace

FieldText text_of(const Field& field, const std::string& unit) {
    const auto number = [&](double value) { return number_text(value, field.unit) + unit; };
    const std::string range = field.interval ? fmt::format("{} to {}", number_text(field.interval->lo, field.unit),
                                                           number_text(field.interval->hi, field.unit))
                                             : "";
    switch (field.state) {
        case State::measured:
            return {number(field.value), range};
        case State::extrapolated:
            return {number(field.value), "extrapolated, " + range};
        case State::at_least:
            return {"at least " + number(field.value), "extrapolated"};
        case State::below:
            return {"below " + number(field.value), ""};
        case State::some_seeds:
            return {"not by all seeds", fmt::format("by {:.0f} of {}", field.value, field.seeds)};
        case State::not_reached:
            return {csv_state(field), field.reason};
        case State::never:
            return {"never", fmt::format("error floor {} %", number_text(field.value, field.unit))};
        case State::unbiased:
            return {"0", "unbiased"};
        case State::no_image:
            return {fmt::format("no image yet; first after {} s", short_number(field.value)), ""};
        case State::below_noise:
            if (!std::isnan(field.value)) return {"below " + number(field.value), "the reference's noise"};
            if (*field.reason != '\0') return {field.reason, ""};
            break;
        default:
            break;
    }
    return {csv_state(field), ""};
}

std::string line_of(const Field& field, const std::string& unit) {
    const auto [value, detail] = text_of(field, unit);
    return detail.empty() ? value : fmt::format("{} ({})", value, detail);
}

std::string csv_state(const Field& field) {
    // In the order of State.
    constexpr const char* names[] = {"",
                                     "measured",
                                     "extrapolated",
                                     "at least",
                                     "below",
                                     "some seeds",
                                     "not reached",
                                     "never",
                                     "unbiased",
                                     "below the reference's noise",
                                     "inconclusive",
                                     "no image",
                                     "no verdict"};
    static_assert(std::size(names) == static_cast<std::size_t>(State::no_verdict) + 1);
    return names[static_cast<std::size_t>(field.state)];
}

std::string left_out(const TableRow& row) { return words_of(LeftOut{row.effects_missing, row.components_missing}); }

std::string error_kind(const TableRow& row) {
    if (!row.contradicted_in.empty()) return "bias, although declared unbiased";
    const Field share = bias_share_field(row);
    const auto percent = [](double value) { return whole_percent(value) + " %"; };
    switch (share.state) {
        case State::unbiased:
            return unsampled_share(row) > 0 ? fmt::format("noise, {} unsampled light", percent(unsampled_share(row)))
                                            : "noise";
        case State::below:
            if (share.value >= 0.5) return "inconclusive, bias below " + percent(share.value);
            return share.value < 0.005 ? "noise" : "noise, bias below " + percent(share.value);
        case State::measured:
            return percent(share.value) + " bias";
        case State::inconclusive:
            if (!row.floor_known) return "inconclusive: reference's error unknown";
            return row.statistics->rel_bias2 && row.statistics->rel_bias2->interval ? "inconclusive"
                                                                                    : "needs two seeds";
        default:
            return "";
    }
}

std::string words_of(const Doubts& doubts) {
    std::string text;
    if (!doubts.ties.empty())
        text = doubts.one_seed ? "inconclusive: one seed" : "not significantly different from " + named(doubts.ties);
    for (const auto& [words, methods] :
         {std::pair("inconclusive, one seed: ", &doubts.lone), {"not run longer: ", &doubts.open}})
        if (!methods->empty()) text += (text.empty() ? "" : "; ") + (words + named(*methods));
    return text;
}

std::string doubts(const std::vector<Contender>& ranking) {
    const Contender* best = best_of(ranking);
    return best ? words_of(doubts_about(best->method, ranking)) : "";
}

SceneLook scene_look(const Analysis& analysis, const std::string& scene) {
    const Contest contest(analysis, scene);
    if (contest.methods() == 0) return {};
    SceneLook all{contest.equal_time()};
    const auto ranking = contest.after(all.seconds);
    const bool has_best = contest.is_judged() && ranking.size() > 1;
    for (const Contender& c : ranking) {
        const auto look = std::ranges::find_if(analysis.looks,
                                               [&](const auto& l) { return l.scene == scene && l.method == c.method; });
        const TableRow* total = analysis.row(scene, c.method, Layer::total);
        if (look == analysis.looks.end() || !total) continue;
        const bool is_late = c.standing == Standing::no_image;
        all.methods.push_back(
            {.look = *look,
             .standing = has_best || is_late ? c.standing : Standing::open,
             .error = error_of(c, *total),
             .beside = has_best ? beside_text(ranking, c) : "",
             .flip = look->flip && !is_late ? measured(*look->flip) : Field{},
             .kind = error_kind(*total),
             .missing = left_out(*total),
             .energy = different_energy(analysis, *look),
             .shown = fmt::format("{}{} pass{}, {} s", look->is_final ? "final image, " : "", look->passes,
                                  look->passes == 1 ? "" : "es", short_number(look->seconds))});
    }
    return all;
}

std::vector<VerdictRow> verdict(const Analysis& analysis, const std::string& scene) {
    return Answers(analysis, scene).verdict();
}

ShortAnswer cheapest(const Analysis& analysis, const std::string& scene, std::size_t target) {
    for (const VerdictRow& v : verdict(analysis, scene)) {
        if (!v.target) return {"no verdict", v.remark};
        if (v.target != target) continue;
        if (v.method.empty()) return {"below the reference's noise", v.remark};
        std::string doubt = v.doubts.empty() ? "" : ", " + v.doubts;
        std::ranges::replace(doubt, '`', '\'');  // the page's head has no code
        if (v.is_best) return {v.method, short_number(v.seconds.value) + " s" + doubt};
        const bool has_time = v.seconds.state == State::extrapolated || v.seconds.state == State::at_least;
        return {"not reached", fmt::format("closest: {}, {} after {} s{}{}", v.method, line_of(v.error, " %"),
                                           short_number(analysis.row(scene, v.method, Layer::total)->seconds),
                                           has_time ? "; " + line_of(v.seconds, " s") : "", doubt)};
    }
    return {"not reached", ""};
}

std::string help_of(const Warning& warning) {
    if (warning.command.empty()) return "";
    return fmt::format(". `{}` {}", warning.command,
                       warning.kind == Warning::Kind::reference_contradicted
                           ? "makes a better one, to be given as `image` of `[reference]`"
                           : "measures it again");
}

std::string sentence_of(const Warning& warning) {
    return fmt::format("Warning: {}{}.", warning.sentence, help_of(warning));
}

std::string about_scene(const std::string& scene, const std::string& sentence) {
    return scene.empty() ? sentence : scene + ": " + sentence;
}

}  // namespace gib
