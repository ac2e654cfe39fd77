#pragma once
// Files of hard cases: scenes whose answer theory gives, and the methods that must find it.
//
//     title = "Hard cases"
//     seeds = 8                    # replicates, from whose scatter the interval of each mean comes
//     alpha = 0.01                 # the chance that any verdict of the file is wrong where all answers are right
//     resolve = "5%"               # an answer whose interval is wider than this, to either side, is unresolved; a
//                                  # bound, if the interval ends further above it
//     [[method]]                   # as in every experiment
//     name = "radiosity"
//     [leaves_out]                 # effects that methods whose label contains the key may leave out of a scene's; a
//     radiosity = ["refraction"]   # method that leaves out more fails
//     [[case]]
//     scene = "../scenes/hard/glass.xml"
//     name = "glass"               # else the scene's
//     set = { eta = [1, 3] }       # the scene's parameters; a list makes a case of each value
//     expected = 1.0               # the mean over pixels and channels; or at_most = 1.0, black = true,
//                                  # refused = "what the message has to say"
//     at_least = 0.9               # beside at_most
//     accuracy = 1e-5              # of the number expected, relative
//     reason = "why that is the answer"
//     passes = 16
//     seeds = 32                   # instead of the file's
//     every_pixel = true           # the answer holds for each pixel, without noise
//     without = { radiosity = "why it cannot be judged" }

#include "common/scene/effects.h"
#include "experiments/plan/experiment_file.h"

#include <map>
#include <string>
#include <vector>

namespace gib {

/// How the mean radiance of an image stands to what is expected; `refused`: there must be no image.
enum class Relation { equal, at_most, black, refused };
std::string_view name_of(Relation relation);

struct HardCase {
    std::string name;   ///< with the parameters that are swept: `glass eta=3`
    std::string scene;  ///< path, as the program opens it
    std::map<std::string, std::string> parameters;
    Relation relation = Relation::equal;
    double expected = 0;   ///< [W/(sr m^2)] mean over pixels and channels
    double at_least = 0;   ///< the same, beside `at_most`; 0: no bound
    double accuracy = 0;   ///< of `expected`, relative: its formula's, and the rounding of the renderer's floats
    std::string refusal;   ///< what the message of a refusal contains
    std::string reason;    ///< why that is the answer
    std::uint32_t passes;  ///< samples a pixel
    int seeds;             ///< images: 1 to this
    bool every_pixel;      ///< whether the answer holds for each pixel
    std::map<std::string, std::string> without;  ///< part of a label: why it is not judged
};

struct HardCases {
    std::string path, name, title, text;
    int seeds = 8;
    double alpha = 0.01;
    double resolve = 0.05;
    std::vector<MethodLabel> methods;
    std::map<std::string, Effects> leaves_out;  ///< part of a label: what methods may leave out
    std::vector<HardCase> cases;

    /// The effects that this method may leave out.
    Effects may_leave_out(const MethodLabel& method) const;

    /// What each verdict may be wrong with, so that all of them together are with `alpha` (Bonferroni).
    double tail() const { return alpha / static_cast<double>(cases.size() * methods.size()); }
};

/// Whether an experiment file is one of hard cases: it has [[case]] tables.
bool holds_hard_cases(const std::string& path);

/// Throws InputError (`file:line:column: message`) as load_experiment() does.
HardCases load_hard_cases(const std::string& path);
HardCases parse_hard_cases(const std::string& text, const std::string& path);

}  // namespace gib
