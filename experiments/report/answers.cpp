#include "experiments/report/answers.h"

#include "experiments/analysis/contest.h"
#include "experiments/analysis/row_fields.h"
#include "experiments/analysis/table_row.h"
#include "experiments/report/field_text.h"
#include "experiments/report/words.h"
#include "experiments/text/numbers.h"
#include "methods/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace gib {

namespace {

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
            return {VerdictRow{.remark = fmt::format("the reference does not judge the light of {}",
                                                     words_of(analysis_.unjudged(scene_)))}};
        std::vector<VerdictRow> rows;
        for (const std::size_t target : asked_targets) {
            const auto ranking = contest_.to_error(target);
            const auto of_target = best_of(ranking) ? with_winner(ranking, target) : without_winner(target);
            rows.insert(rows.end(), of_target.begin(), of_target.end());
        }
        return rows;
    }

    ShortAnswer short_answer(std::size_t target) const {
        if (!contest_.is_judged()) return {"not judged", ""};
        const auto ranking = contest_.to_error(target);
        if (const Contender* best = best_of(ranking)) {
            const std::string seconds = short_number(row(best->method).times[target]->value) + " s";
            return {best->method, seconds + (ranking.size() > 1 ? after_comma(doubts(ranking)) : "")};
        }
        if (!is_target_resolved(target, contest_.noise_floor())) return {"not resolved", ""};
        const auto closest = contest_.by_final_images();
        const TableRow* first = closest.empty() ? nullptr : analysis_.row(scene_, closest.front().method, Layer::total);
        if (!first || !first->statistics) return {"not reached", ""};
        // Its error, and the time to the target by the fitted law, if there is one.
        const Field time = time_field(*first, target), error = row_of(first->method, target, INFINITY).error;
        const bool has_time = time.state == State::extrapolated || time.state == State::at_least;
        return {"not reached", fmt::format("closest: {}, {} after {} s{}{}", first->method, line_of(error, " %"),
                                           short_number(first->seconds), has_time ? "; " + line_of(time, " s") : "",
                                           after_comma(doubts(closest)))};
    }

private:
    const TableRow& row(const std::string& method) const { return *analysis_.row(scene_, method, Layer::total); }
    /// The page's head has no code.
    static std::string after_comma(std::string text) {
        std::erase(text, '`');
        return text.empty() ? "" : ", " + text;
    }

    /// The components' shares of the sum of their squared errors after `seconds`, largest first, without those below half a
    /// percent: "90 % caustic, 10 % indirect"; empty if there is none.
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

    /// For each method name other than the first one's, the label that stands first.
    std::vector<std::string> best_of_other_names(const std::vector<std::string>& methods) const {
        std::set<std::string> named = {name_in(methods.front())};
        std::vector<std::string> best;
        for (const std::string& method : methods)
            if (analysis_.row(scene_, method, Layer::total) && named.insert(name_in(method)).second)
                best.push_back(method);
        return best;
    }
    std::string name_in(const std::string& method) const { return MethodLabel::parse(analysis_.label_of(method)).name; }

    std::vector<VerdictRow> with_winner(const std::vector<Contender>& ranking, std::size_t target) const {
        const Contender& best = ranking.front();
        const double seconds = row(best.method).times[target]->value;
        std::vector<std::string> methods;
        for (const Contender& c : ranking)
            if (c.known == Contender::Known::equal) methods.push_back(c.method);
        for (const Contender& c : contest_.after(seconds))
            methods.push_back(c.method);
        std::vector<std::string> shown = best_of_other_names(methods);
        if (ranking.size() > 1 && ranking[1].is_complete && ranking[1].known == Contender::Known::equal &&
            std::ranges::find(shown, ranking[1].method) == shown.end())
            shown.insert(shown.begin(), ranking[1].method);

        std::vector<VerdictRow> rows = {row_of(best.method, target, seconds)};
        rows[0].is_best = true;
        rows[0].factor = measured(1);
        rows[0].remark = ranking.size() == 1                               ? ""
                         : doubts_about(best.method, ranking).open.empty() ? "cheapest"
                                                                           : "first that was seen to reach it";
        if (const std::string doubt = doubts(ranking); !doubt.empty()) rows[0].remark += ", " + doubt;
        for (const std::string& method : shown) {
            VerdictRow& other = rows.emplace_back(row_of(method, target, seconds));
            other.factor = times_as_much(other.seconds, 1 / seconds);
            const bool is_tie = std::ranges::any_of(
                ranking, [&](const Contender& c) { return c.method == method && c.standing == Standing::tie; });
            if (is_tie) other.remark = "tie with the best";
        }
        return rows;
    }

    std::vector<VerdictRow> without_winner(std::size_t target) const {
        if (!is_target_resolved(target, contest_.noise_floor()))
            return {{.target = target,
                     .remark = fmt::format("the reference resolves {} % only",
                                           percent_text(std::sqrt(contest_.noise_floor())))}};
        const auto closest = contest_.by_final_images();
        std::vector<std::string> methods;
        for (const Contender& c : closest)
            methods.push_back(c.method);
        if (const TableRow* first = analysis_.row(scene_, methods.front(), Layer::total); !first || !first->statistics)
            return {};
        std::vector<VerdictRow> rows = {row_of(methods.front(), target, INFINITY)};
        const std::string doubt = doubts(closest), &left = rows[0].remark;
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

std::vector<VerdictRow> verdict(const Analysis& analysis, const std::string& scene) {
    return Answers(analysis, scene).verdict();
}

ShortAnswer cheapest(const Analysis& analysis, const std::string& scene, std::size_t target) {
    return Answers(analysis, scene).short_answer(target);
}

std::string sentence_of(const Warning& warning) {
    const bool is_reference = warning.kind == Warning::Kind::reference_contradicted;
    const std::string help =
        warning.command.empty()
            ? ""
            : fmt::format(
                  " `{}` {}.", warning.command,
                  is_reference ? "makes a better one, to be given as `image` of `[reference]`" : "measures it again");
    return fmt::format("Warning: {}.{}", warning.sentence, help);
}

}  // namespace gib
