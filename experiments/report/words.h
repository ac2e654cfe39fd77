#pragma once
// Words for table.md, the report and the terminal: fields as text, bias or noise of a method's error, missing light,
// the relation to the best method, and the cheapest method.

#include "experiments/analysis/field.h"
#include "experiments/analysis/ranking.h"
#include "experiments/analysis/table_row.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace gib {

/// A field of a table: Markdown has `detail` in brackets, the page in small letters below.
struct FieldText {
    std::string value, detail;
};

/// "12.3" with "11.0 to 14.1"; "42.0" with "extrapolated, 35.1 to 50.2"; "never" with "error floor 3.00 %". `unit`
/// follows each number.
FieldText text_of(const Field& field, const std::string& unit = "");
/// Both on one line: "12.3 (11.0 to 14.1)".
std::string line_of(const Field& field, const std::string& unit = "");

/// The state in words; empty if there is none.
std::string csv_state(const Field& field);

/// The light and the effects that a method leaves out, such as "refraction; light of direct, indirect".
std::string left_out(const TableRow& row);

/// Whether the error of the final images is bias or noise, in at most six words: "63 % bias", "noise, bias below 16 %",
/// "inconclusive". The shares are bias^2 / (bias^2 + variance); bias_share_field() has their intervals. "noise" for a method
/// that is declared unbiased and leaves out nothing, unless its mean energy contradicts that. Empty without statistics.
std::string error_kind(const TableRow& row);

/// "not significantly different from `a`, `b`", "inconclusive: one seed", "not run longer: `c`"; empty if there are none.
std::string words_of(const Doubts& doubts);
/// Doubts about the best; empty if there are none.
std::string doubts(const std::vector<Contender>& ranking);

struct LookWords {
    EqualTimeLook look;
    Standing standing;        ///< open where no method can be the best
    Field error;              ///< the relative RMSE [%], or why there is none
    std::string beside = {};  ///< as "best, not run longer: `c`"; empty where no method can be the best
    Field flip = {};
    std::string kind;     ///< error_kind()
    std::string missing;  ///< left_out()
    std::string energy;   ///< layers whose mean energy differs from the reference's; may be empty
    std::string shown;    ///< which image of seed 1 it is, "16 passes, 0.41 s"
};

/// The images of a scene after `seconds`, in the order of Contest::after(): the smallest error first, methods that
/// leave out light after complete ones, methods without an image last.
struct SceneLook {
    double seconds = 0;
    std::vector<LookWords> methods = {};
};
SceneLook scene_look(const Analysis& analysis, const std::string& scene);

/// Indices into target_errors of the errors for which the cheapest method is named: 5 % and 1 %.
inline constexpr std::array<std::size_t, 2> asked_targets = {1, 3};

/// A method in the verdict about an error to reach.
struct VerdictRow {
    std::optional<std::size_t> target = {};  ///< index into target_errors; empty: of all of them
    std::string method = "";                 ///< empty: no method is the cheapest, and `remark` says why
    Field seconds = {};                      ///< to the error: measured, or what is known
    Field factor = {};                       ///< `seconds` over the best method's
    Field error = {};         ///< relative RMSE after the best one's time; if none has reached it, of the final images
    std::string parts = "";   ///< components that hold the squared error: "90 % caustic, 10 % indirect"
    std::string kind = "";    ///< bias or noise: error_kind()
    std::string doubts = "";  ///< about the first: doubts()
    std::string remark = "";  ///< its rank, and the light that it leaves out
    bool is_best = false;
    bool is_tie = false;  ///< best with a rival, or rival: not significantly different
};

/// The verdict about a scene: for each of asked_targets the cheapest method, the next one, and the best label of each
/// other method; where none has reached the error, the closest ones. Without a verdict, because the reference lacks a
/// component that holds light or is contradicted in it, there is one row that says so.
std::vector<VerdictRow> verdict(const Analysis& analysis, const std::string& scene);

/// The verdict in a few words: the method that reaches an error first, or why none does.
struct ShortAnswer {
    std::string method;  ///< a label, "not reached", "below the reference's noise" or "no verdict"
    std::string detail;  ///< time and doubts, or the closest method; may be empty
};
ShortAnswer cheapest(const Analysis& analysis, const std::string& scene, std::size_t target);

/// ". `gibench run ...` measures it again"; empty without a command that helps.
std::string help_of(const Warning& warning);
/// "Warning: ...", with the command that helps.
std::string sentence_of(const Warning& warning);
/// A sentence about a scene, "room: ..."; the sentence alone if `scene` is empty.
std::string about_scene(const std::string& scene, const std::string& sentence);

}  // namespace gib
