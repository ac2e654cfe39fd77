#include "experiments/plan/experiment_keys.h"

#include "common/core/nearest_word.h"
#include "experiments/metrics/epsilon.h"
#include "experiments/plan/external_method.h"
#include "experiments/plan/run_options.h"

#include <fmt/format.h>

namespace gib {

namespace {

std::string whole(int upper) { return fmt::format("whole number, 1 to {}", upper); }

DeclaredTable keys_of_the_file() {
    return {"experiment",
            "what is rendered, how often and for how long",
            {{"title", "text; default: the file's name without `.toml`", "heading of the tables and the report"},
             {"scenes", "list of texts; required",
              "scene files, relative to the experiment file, or names that `gibench list scenes` prints. A file comes "
              "before a scene of the same name. No two scenes have the same name"},
             {"paths", "list of folders, relative to the experiment file",
              "where the scenes' files are searched for, after each scene's own folder"},
             {"resolution", fmt::format("`[width, height]`, 1 to {}; default: each scene's own", most_pixels_across),
              "size of every image in pixels"},
             {"seeds", fmt::format("{}; default {}", whole(most_seeds), default_seeds),
              "each method renders each scene with the seeds 1 to this number. One seed gives no bias^2, variance and "
              "intervals"},
             {"epsilon", fmt::format("number, {:g} to {:g}; default: (0.1 m)^2", smallest_epsilon, largest_epsilon),
              "epsilon of relative errors [radiance^2]. By default m is the mean luminance of the scene's "
              "reference: errors do not depend on the unit of light. A number is absolute, for comparison with papers, "
              "which "
              "take 0.01"},
             {"budget", "table", "where a cell ends, unless its `spp` ends it earlier"},
             {"reference", "table", "the images that all others are compared with"},
             {"method", "list of tables; required", "what is compared"},
             {"tune", "table", "searches the cheapest settings instead of `seeds`, budget, reference and methods"}}};
}

DeclaredTable keys_of_a_reference() {
    return {
        "[reference]",
        "how references are made",
        {{"method", "text; default `\"auto\"`",
          "`auto`, which combines all unbiased methods; a name; or a label such as `photon_mapper k=100`, without "
          "`spp`"},
         {"target", "`\"1%\"` or `0.01`, or a list with one for each scene; default 1 % without `seconds`",
          "relative standard error to reach: sqrt(mean(stderr^2 / (r^2 + epsilon))). stderr^2 includes the square of "
          "an "
          "estimated bias where methods that merge had to help. Its square is subtracted from errors, so that smaller "
          "errors can be measured too"},
         {"seconds", "number above 0", "time after which a reference is used as it is; the report gives its error"},
         {"image",
          "file, list of replicates, or a list with one of these for each scene; relative to the experiment file",
          "a reference made elsewhere, instead of all other keys of this table: an image of any renderer, of the size "
          "of the scene's images. Its layer `stderr` (channels `stderr.R`, `stderr.G`, `stderr.B`) is its standard "
          "error per pixel. Several images of the same pass count from other seeds are replicates: their mean is the "
          "reference, their scatter its standard error. Without a standard error nothing is subtracted, bias and noise "
          "are not separated, and `rel_mse_resolved` is empty. A reference of `gibench reference` keeps its groups and "
          "components. That of another scene, or of another version of it, is refused"}},
        "one value of a parameter of the reference's method"};
}

Declared key_of_a_label() {
    return {
        "label", "text; default: the method and those of its settings that vary",
        "name of the rows in tables, report and figures, such as `\"photon map, gathered\"`; the settings that vary "
        "follow it. No two methods have the same"};
}

DeclaredTable keys_of_a_command() {
    return {
        "[[method]] with a command",
        "another renderer",
        {{"name", "word; required", "first word of the rows' labels; not the name of a method of gibench"},
         key_of_a_label(),
         {"command", "text; required",
          "runs in `/bin/sh`, in the folder of the experiment file. Required placeholders: `{scene}` and `{out}`, the "
          "files "
          "to read and to write. Optional: `{spp}`, `{seconds}` (of the budget), `{seed}`, `{threads}`, `{width}`, "
          "`{height}`. Paths are quoted for the shell. A new text makes the cells again; a new version of the "
          "program needs `--fresh`"},
         {"image_format", "`\"exr\"` (default), `\"pfm\"` or `\"hdr\"`",
          "ending of `{out}`. The image holds linear radiance in R, G, B"},
         {"timeout", fmt::format("seconds; default {:g}", ExternalMethod().timeout),
          "the command and all that it has started are killed after this time"}},
        "a number or word, or a list of them: the value of the placeholder of this name (small letters and `_`), a "
        "part "
        "of the label. Required if the command has the placeholder, except `spp`: the scene's `sample_count`, else 16"};
}

DeclaredTable keys_of_tune() {
    return {"[tune]",
            "searches the cheapest settings on each scene, with the options of `gibench tune`",
            {{"target", fmt::format("`\"5%\"` or `0.05`; default {}", default_tuning_target), "relative RMSE to reach"},
             {"method", "list of names or labels; default: every method",
              "methods that are searched; the parameters of a label are fixed"},
             {"vary", "list of texts such as `\"radius=0.05..0.2\"` or `\"kernel=cone,gaussian\"`",
              "further ranges to search; parameters that declare a span (`gibench list methods --parameters`) are "
              "searched anyway"},
             {"minutes", fmt::format("number above 0; default {:g}", default_tuning_minutes), "time for each scene"}}};
}

}  // namespace

const std::vector<DeclaredTable>& experiment_keys() {
    static const std::vector<DeclaredTable> tables = {
        keys_of_the_file(),
        {"[budget]",
         "limits of a cell besides `spp`; the first one that is reached ends it",
         {{"seconds", "number above 0",
           "a cell ends with the pass during which this charged wall-clock time is used up"},
          {"passes", whole(most_budget_passes), "a cell ends after this number of passes"}}},
        keys_of_a_reference(),
        {"[[method]]",
         "a method of gibench, or several labels of it",
         {{"name", "text; required", "a method: `path`, `photon_mapper`, ... (all: `gibench list methods`)"},
          key_of_a_label(),
          {"filter", "`\"none\"` (default), `\"nlm\"`, a command, or a list of them",
           "filters each image; its time is charged. `nlm` is non-local means with two half buffers, guided by albedo, "
           "normal and depth. A command runs like that of another renderer: it reads `{image}` and writes `{out}`. "
           "Optional placeholders: `{albedo}`, `{normal}`, `{depth}`, `{variance}` (EXR files) and `{threads}`. Its "
           "image has no components; its label is the name of its program"}},
         "a value, or a list of values, of a parameter of the method (`gibench list methods --parameters`)"},
        keys_of_a_command(),
        keys_of_tune()};
    return tables;
}

std::string help_with_key(const std::string& key, const std::vector<std::string>& known) {
    for (const DeclaredTable& table : experiment_keys())
        for (const Declared& entry : table.entries)
            if (table.name == "experiment" && entry.name == key && entry.value.find("table") == std::string::npos)
                return "; it belongs above the first [[method]] and all other tables.";
    return did_you_mean_or_stop(key, known);
}

}  // namespace gib
