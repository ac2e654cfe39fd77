#pragma once
// Warnings on top of the tables and the report: times from different or busy processors, and methods whose energy
// balance differs (energy_balance.h).

#include "experiments/analysis/curves.h"
#include "experiments/analysis/table_row.h"

#include <set>
#include <string>
#include <vector>

namespace gib {

/// The names of the processors of these cells; records of older versions have none.
std::set<std::string> processors_of(const Runs& cells);

/// A warning that names the processors of a scene's cells and the methods that each one has measured; empty if all are
/// alike.
std::optional<Warning> unlike_processors(const std::vector<Cell>& cells, const std::string& scene);

/// The signs of a machine that was busy when it measured the runs of a method, as in busy_machine(); empty if there are
/// none.
std::string busy_sign(const Analysis& analysis, const std::string& method, const Runs& cells);

/// Whether the methods of a scene are better compared after equal passes than after equal times: a machine was busy
/// that measured one of them, or the experiment gives no time after which runs end.
bool calls_for_equal_passes(const Analysis& analysis, const std::string& scene);

/// One warning about all scenes, which names the methods whose cells had to wait for a processor, or whose seeds took
/// unlike times for a pass, and the command that measures them again (`run_command` is empty for a tuning). Empty if
/// there are none.
std::optional<Warning> busy_machine(const Analysis& analysis, const std::string& run_command);

/// Warnings that name method and layers: one for each method with layers that differ from the reference; and, where the
/// reference is inconclusive in a component, one for the two methods that differ most significantly from each other.
std::vector<Warning> balance_warnings(const Analysis& analysis);

/// The contradiction of a method that is declared unbiased: "biased, although declared unbiased: mean energy relative
/// to the reference's `indirect` -3.10 % (-3.80 to -2.40)".
std::string contradiction(const Analysis& analysis, const TableRow& total);
/// One for each method of a scene that is biased although it is declared unbiased.
std::vector<Warning> contradicted_declarations(const Analysis& analysis, const std::string& scene);

}  // namespace gib
