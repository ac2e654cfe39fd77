#include "experiments/report/answers.h"

#include "experiments/analysis/contest.h"
#include "experiments/analysis/left_out.h"
#include "experiments/analysis/price.h"
#include "experiments/report/error_words.h"
#include "experiments/report/field_text.h"
#include "experiments/text/numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace gib {

namespace {

std::string in_brackets(const std::string& text) { return text.empty() ? "" : " (" + text + ")"; }

std::optional<double> mean_error2(const Runs& cells, Layer layer, double seconds) {
    const auto errors2 = errors2_by(cells, layer, seconds);
    return errors2.empty() ? std::nullopt : std::optional(sample_mean(errors2).value);
}

/// The answers of one scene.
class Answers {
public:
    Answers(const Analysis& analysis, std::string scene)
        : analysis_(analysis), scene_(std::move(scene)), contest_(analysis, scene_) {}

    std::vector<std::string> all() const {
        if (!contest_.is_judged() && contest_.methods() > 1)
            return {fmt::format("No method is the cheapest: the reference does not judge the light of {}.",
                                words_of(analysis_.unjudged(scene_), "`"))};
        std::vector<std::string> answers;
        if (judged_methods() > 1)
            for (const std::size_t target : asked_targets) {
                const auto ranking = contest_.to_error(target);
                answers.push_back(best_of(ranking) ? with_winner(ranking, target) : without_winner(target));
            }
        return answers;
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
        // Its time by the fitted law, if there is one.
        const Field time = time_field(*first, target);
        const bool has_time = time.state == State::extrapolated || time.state == State::at_least;
        return {"not reached", fmt::format("closest: {}{}{}", first->method, has_time ? ", " + line_of(time, " s") : "",
                                           after_comma(doubts(closest)))};
    }

private:
    const TableRow& row(const std::string& method) const { return *analysis_.row(scene_, method, Layer::total); }
    std::size_t judged_methods() const {
        return static_cast<std::size_t>(std::count_if(
            analysis_.rows.begin(), analysis_.rows.end(),
            [&](const TableRow& r) { return r.scene == scene_ && r.layer == Layer::total && r.statistics; }));
    }
    /// The page's head has no code.
    static std::string after_comma(std::string text) {
        std::erase(text, '`');
        return text.empty() ? "" : ", " + text;
    }

    /// A text with the components' shares of the sum of their squared errors after `seconds`, largest first, without those
    /// below half a percent; empty if there is none.
    std::string parts_of_error(const Runs& cells, double seconds) const {
        double sum = 0;
        std::vector<std::pair<double, Layer>> parts;
        for (const Layer layer : layers_of(analysis_, scene_)) {
            const auto error2 = mean_error2(cells, layer, seconds);
            if (layer == Layer::total || !error2 || !(*error2 > 0)) continue;
            sum += *error2;
            parts.emplace_back(*error2, layer);
        }
        std::stable_sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
        std::string text;
        for (const auto& [error2, layer] : parts)
            if (error2 >= 0.005 * sum)
                text += fmt::format(", {:.0f} % {}in `{}`", 100 * error2 / sum,
                                    text.empty() ? "of its squared error " : "", name_of(layer));
        return text;
    }

    /// Says how large the error of a method is after `seconds` (if infinite: that of its final images, as in the table of
    /// errors), which component has most of it, what the method leaves out and, if `with_time`, when it reaches the
    /// target: why it is behind one that has reached the target by then.
    std::string what_keeps(const std::string& method, std::size_t target, double seconds, bool with_time) const {
        const Runs& cells = contest_.cells().at(method);
        const TableRow& of = row(method);
        const bool ended = of.seconds < seconds && !have_converged(cells);
        std::string text = fmt::format("fter {} s `{}` has ", short_number(ended ? of.seconds : seconds), method);
        const auto error2 = mean_error2(cells, Layer::total, seconds);
        if (!error2) text += "no image yet";
        else if (!(*error2 > contest_.noise_floor())) text += "an error below what the reference resolves";
        else
            text += line_of(measured(*error2, Unit::root), " %") + parts_of_error(cells, seconds) +
                    in_brackets(error_kind(of));
        if (ended && std::isfinite(seconds)) text += ", and was not run longer";
        if (!of.effects_missing.empty()) text += ", leaves out " + words_of(of.effects_missing);
        if (!of.components_missing.empty()) text += ", leaves out light of " + words_of(of.components_missing, "`");
        const std::string time = with_time ? line_of(time_field(of, target)) : "";
        return text + (time.empty() ? "." : fmt::format("; seconds to {} %: {}.", target_names[target], time));
    }

    /// For each method name other than the winner's, the label that comes closest to the target.
    std::vector<std::string> best_of_other_names(const std::vector<Contender>& ranking, double seconds) const {
        const auto name = [](const std::string& method) { return method.substr(0, method.find(' ')); };
        std::set<std::string> named = {name(ranking.front().method)};
        std::vector<std::string> best;
        const auto add = [&](const Contender& c) {
            if (named.insert(name(c.method)).second) best.push_back(c.method);
        };
        for (const Contender& c : ranking)
            if (c.known == Contender::Known::equal) add(c);
        for (const Contender& c : contest_.after(seconds))
            if (analysis_.row(scene_, c.method, Layer::total)) add(c);
        return best;
    }

    std::string with_winner(const std::vector<Contender>& ranking, std::size_t target) const {
        const TableRow& winner = row(ranking.front().method);
        const Estimate& time = *winner.times[target];
        const bool is_known = doubts_about(winner.method, ranking).open.empty();
        std::string text = fmt::format("`{}` {} {} %{}: {} s", winner.method,
                                       is_known ? "is the cheapest at" : "is the first that was seen to reach",
                                       target_names[target], in_brackets(doubts(ranking)), with_interval(time));
        if (winner.prepare_seconds > 0.1 * time.value)
            text += fmt::format(", of which {} s are preparation", short_number(winner.prepare_seconds));
        text += ".";
        if (const std::string kind = error_kind(winner); !kind.empty()) text += fmt::format(" Its error: {}.", kind);
        const bool has_next =
            ranking.size() > 1 && ranking[1].is_complete && ranking[1].known == Contender::Known::equal;
        if (has_next)
            text += fmt::format(" `{}` takes {} times as long{}.", ranking[1].method,
                                short_number(row(ranking[1].method).times[target]->value / time.value),
                                ranking[1].standing == Standing::tie ? " (a tie)" : "");
        for (const std::string& other : best_of_other_names(ranking, time.value))
            text += " A" + what_keeps(other, target, time.value, !has_next || other != ranking[1].method);
        return text;
    }

    std::string without_winner(std::size_t target) const {
        if (!is_target_resolved(target, contest_.noise_floor()))
            return fmt::format("The reference does not resolve {} %, only {} %.", target_names[target],
                               percent_text(std::sqrt(contest_.noise_floor())));
        const bool any_reached = std::any_of(analysis_.rows.begin(), analysis_.rows.end(), [&](const TableRow& r) {
            return r.scene == scene_ && r.layer == Layer::total && r.times[target].has_value();
        });
        const auto closest = contest_.by_final_images();
        return fmt::format("No method {}reached {} %{}. Closest{}: a{}",
                           any_reached ? "with all light of the scene " : "", target_names[target],
                           seeds_that_reached(target), in_brackets(doubts(closest)),
                           what_keeps(closest.front().method, target, INFINITY, true));
    }
    std::string seeds_that_reached(std::size_t target) const {
        const bool some = std::any_of(analysis_.rows.begin(), analysis_.rows.end(), [&](const TableRow& r) {
            return r.scene == scene_ && r.layer == Layer::total && !r.times[target] && r.reached[target] > 0;
        });
        return some ? " with all seeds" : "";
    }

    const Analysis& analysis_;
    std::string scene_;
    Contest contest_;
};

}  // namespace

std::vector<std::string> price_answers(const Analysis& analysis, const std::string& scene) {
    return Answers(analysis, scene).all();
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
