#pragma once
// Reads files of hard cases: scenes whose mean radiance is known from theory, and the methods that must find it.
//
//     title = "Hard cases"
//     seeds = 8                    # replicates; the interval of each mean follows from their scatter
//     alpha = 0.01                 # probability that at least one verdict is wrong although all methods are right
//     resolve = "5%"               # largest half width of an interval, relative to the answer; beyond it, a case is
//                                  # unresolved. With a bound: how far outside of it the interval may end
//     [[method]]                   # as in every experiment
//     name = "radiosity"
//     [leaves_out]                 # effects that a method may leave out if its label contains the key; a method that
//     radiosity = ["refraction"]   # leaves out others fails
//     [[case]]
//     scene = "../scenes/hard/glass.xml"
//     name = "glass"               # default: the name of the scene's file
//     set = { eta = [1, 3] }       # $parameters of the scene; a list makes one case of each value
//     expected = 1.0               # mean radiance over pixels and channels; instead: at_most = 1.0, black = true or
//                                  # refused = "text that the error message has to contain"
//     at_least = 0.9               # only together with at_most
//     accuracy = 1e-5              # relative, of the expected number
//     reason = "why that is the answer"
//     passes = 16                  # samples a pixel
//     seeds = 32                   # instead of the file's
//     every_pixel = true           # each pixel has the answer, without noise
//     without = { radiosity = "why it cannot be judged" }  # for methods whose label contains the key

#include "common/scene/effects.h"
#include "experiments/plan/experiment_file.h"

#include <map>
#include <string>
#include <vector>

namespace gib {

/// How the mean radiance of an image has to relate to the expected one. `refused`: the scene must give an error.
enum class Relation { equal, at_most, black, refused };
std::string_view name_of(Relation relation);

struct HardCase {
    std::string name;   ///< with the swept parameters: `glass eta=3`
    std::string scene;  ///< path of its file, as the program opens it
    std::map<std::string, std::string> parameters;
    Relation relation = Relation::equal;
    double expected = 0;   ///< [W/(sr m^2)] mean over pixels and channels
    double at_least = 0;   ///< lower bound beside `at_most` [W/(sr m^2)]; 0: none
    double accuracy = 0;   ///< relative, of `expected`: error of its formula and of the renderer's rounding
    std::string refusal;   ///< text that the message of a refusal has to contain
    std::string reason;    ///< why that is the answer
    std::uint32_t passes;  ///< samples a pixel
    int seeds;             ///< seeds 1 to this are rendered
    bool every_pixel;      ///< whether the answer holds for each pixel
    std::map<std::string, std::string> without;  ///< part of a label -> why such methods are not judged
};

struct HardCases {
    std::string path, name, title, text;
    int seeds = 8;
    double alpha = 0.01;
    double resolve = 0.05;
    std::vector<MethodLabel> methods;
    std::map<std::string, Effects> leaves_out;  ///< part of a label -> what such methods may leave out
    std::vector<HardCase> cases;

    /// The effects that this method may leave out.
    Effects may_leave_out(const MethodLabel& method) const;

    /// The probability with which each verdict may be wrong, so that at least one of all verdicts is wrong with
    /// probability at most `alpha` (Bonferroni).
    double tail() const { return alpha / static_cast<double>(cases.size() * methods.size()); }
};

/// Whether an experiment file holds hard cases, that is, has [[case]] tables.
bool holds_hard_cases(const std::string& path);

/// Throws InputError (`file:line:column: message`) as load_experiment() does.
HardCases load_hard_cases(const std::string& path);
HardCases parse_hard_cases(const std::string& text, const std::string& path);

}  // namespace gib
