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
              "scene files, relative to the experiment file, or names that `gibench list scenes` prints; a file comes "
              "before a "
              "scene of that name, and no two scenes may have the same name"},
             {"paths", "list of folders, relative to the experiment file",
              "where the scenes' files are searched for, after each scene's own folder"},
             {"resolution", fmt::format("`[width, height]`, 1 to {}; default: each scene's own", most_pixels_across),
              "size of every image in pixels"},
             {"seeds", fmt::format("{}; default {}", whole(most_seeds), default_seeds),
              "each method renders each scene with the seeds 1 to this number; 1 leaves bias^2, variance and the "
              "intervals over the seeds empty"},
             {"epsilon", fmt::format("number, {:g} to {:g}; default: (0.1 m)^2", smallest_epsilon, largest_epsilon),
              "epsilon of relative errors [radiance^2]. By default m is the mean luminance of a scene's reference, so "
              "that no error and no verdict depends on the unit of light; it is 0.01 at a mean of 1. A number is "
              "absolute, for comparison with papers, which take 0.01"},
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
          "relative standard error at which a reference is good enough: sqrt(mean(stderr^2 / (r^2 + epsilon))), "
          "with the square of an estimated bias added to stderr^2 where methods that merge had to help. Its square "
          "is subtracted from errors, so that smaller errors are resolved too"},
         {"seconds", "number above 0",
          "time after which a reference is taken as it is; the report says how close it came"},
         {"image",
          "file, list of replicates, or a list with one of these for each scene; relative to the experiment file",
          "a reference made elsewhere, instead of all other keys of this table: an image of any renderer, of the size "
          "of the scene's images. Its layer `stderr` (channels `stderr.R`, `stderr.G`, `stderr.B`) is its standard "
          "error per pixel, whose square is subtracted from errors. Several images of the same pass count from other "
          "seeds are replicates: their mean is the reference, and their scatter its standard error. Without either the "
          "noise floor is unknown, nothing is subtracted, bias and noise are not separated, `rel_mse_resolved` is "
          "empty, and `table.md` and the report say so. A reference of `gibench reference` counts with its groups and "
          "components; one of another scene, or of another version of "
          "it, is refused"}},
        "one value of a parameter of the reference's method"};
}

Declared key_of_a_label() {
    return {"label", "text; default: the method and those of its settings that vary",
            "what the rows are called in tables, report and figures, such as `\"photon map, gathered\"`, with the "
            "settings that "
            "vary. No two methods have the same"};
}

DeclaredTable keys_of_a_command() {
    return {
        "[[method]] with a command",
        "another renderer",
        {{"name", "word; required", "first word of the rows' labels; no method of gibench has it"},
         key_of_a_label(),
         {"command", "text; required",
          "runs in `/bin/sh`, in the folder of the experiment file. `{scene}` and `{out}` are the files to read and "
          "to write, and have to be there; `{spp}`, `{seconds}` (of the budget), `{seed}`, `{threads}`, `{width}`, "
          "`{height}` may. Paths are quoted for the shell where they need it. Complete cells are kept as long as this "
          "text is the same; a new version of the program is not noticed (`--fresh`)"},
         {"image_format", "`\"exr\"` (default), `\"pfm\"` or `\"hdr\"`",
          "ending of `{out}`. The image holds linear radiance in R, G, B"},
         {"timeout", fmt::format("seconds; default {:g}", ExternalMethod().timeout),
          "the command and all that it has started are killed after this time"}},
        "a number or word, or a list of them: the value of the placeholder of this name, of small letters and `_`, "
        "which stands in the label and is required if the command has it; `spp` is the scene's `sample_count`, else "
        "16, if it is not given"};
}

DeclaredTable keys_of_tune() {
    return {"[tune]",
            "searches the cheapest settings on each scene, with the options of `gibench tune`",
            {{"target", fmt::format("`\"5%\"` or `0.05`; default {}", default_tuning_target), "relative RMSE to reach"},
             {"method", "list of names or labels; default: every method",
              "methods that are searched; parameters that a label gives stay"},
             {"vary", "list of texts such as `\"radius=0.05..0.2\"` or `\"kernel=cone,gaussian\"`",
              "what is searched besides the parameters that declare a span (`gibench list methods --parameters`)"},
             {"minutes", fmt::format("number above 0; default {:g}", default_tuning_minutes), "time for each scene"}}};
}

}  // namespace

const std::vector<DeclaredTable>& experiment_keys() {
    static const std::vector<DeclaredTable> tables = {
        keys_of_the_file(),
        {"[budget]",
         "limits of a cell besides `spp`; the first one that is reached counts",
         {{"seconds", "number above 0",
           "a cell ends with the pass during which this charged wall-clock time is used up"},
          {"passes", whole(most_budget_passes), "a cell ends after this number of passes"}}},
        keys_of_a_reference(),
        {"[[method]]",
         "a method of gibench, or several labels of it",
         {{"name", "text; required",
           "a method that estimates radiance: `path`, `photon_mapper`, ... (`gibench list methods` says which there "
           "are)"},
          key_of_a_label(),
          {"filter", "`\"none\"` (default), `\"nlm\"`, a command, or a list of them",
           "filters each image: its time is charged, and its bias stands in the tables. `nlm` is non-local means with "
           "two half buffers, "
           "guided by albedo, normal and depth. A command runs like that of another renderer; it reads `{image}` and "
           "writes `{out}`, and may "
           "take `{albedo}`, `{normal}`, `{depth}` and `{variance}` (EXR files) and `{threads}`; its image has no "
           "components. In "
           "labels it has the name of its program"}},
         "a value, or a list of values, of a parameter of the method (`gibench list methods --parameters`)"},
        keys_of_a_command(),
        keys_of_tune()};
    return tables;
}

std::string help_with_key(const std::string& key, const std::vector<std::string>& known) {
    for (const DeclaredTable& table : experiment_keys())
        for (const Declared& entry : table.entries)
            if (table.name == "experiment" && entry.name == key && entry.value.find("table") == std::string::npos)
                return "; it stands above the first [[method]] and all other tables.";
    return did_you_mean_or_stop(key, known);
}

}  // namespace gib
