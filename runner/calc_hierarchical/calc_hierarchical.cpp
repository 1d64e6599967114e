// jnd calc hierarchical: one model of everybody's answers, the JND of the group and of each person.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/hierarchical/model_variants.h"
#include "runner/calc/calc.h"
#include "runner/calc/trials_input.h"
#include "runner/calc_hierarchical/hierarchical_result.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/progress_bar.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/work_line.h"

namespace jnd {

namespace {

// By which share the interval of ln JND is narrower than that of the same answers without their sureness; NaN where
// one of the two has an open end.
std::vector<double> narrower_by(const HierarchicalResult& result, double most_work) {
  std::vector<HierarchicalCell> cells = result.answers.cells;
  for (HierarchicalCell& cell : cells) cell.sure_positive = cell.sure_negative = 0;
  HierarchicalModel model = result.model;
  model.estimated = model.estimated.with(SharedParameter::sure_below, false).with(SharedParameter::sure_above, false);
  HierarchicalAnalysis analysis(std::move(cells), model);
  const std::vector<ConditionMean>& without = analysis.complete({.intervals = true, .most_work = most_work}).conditions;
  std::vector<double> shares;
  const auto width = [](const ConditionMean& one) { return one.ends.high - one.ends.low; };
  for (std::size_t c = 0; c < without.size(); ++c) {
    const double share = 1 - width(result.fit.conditions[c]) / width(without[c]);
    shares.push_back(std::isfinite(width(without[c])) && std::isfinite(share) ? share : kNaN);
  }
  return shares;
}

// Says which conditions without a JND have answers that fall with the level.
std::vector<bool> falling_of(const HierarchicalResult& result) {
  std::vector<bool> falling;
  for (std::size_t c = 0; c < result.fit.conditions.size(); ++c) {
    std::vector<AnsweredLevel> levels;
    for (const HierarchicalCell& cell : result.answers.cells)
      if (cell.condition == static_cast<int>(c))
        levels.push_back(
            {result.origin() + cell.level, std::llround(cell.counts().trials()), std::llround(cell.positive)});
    const std::string name = result.fit.conditions.size() > 1 ? printable(result.answers.conditions[c]) : "";
    falling.push_back(result.fit.conditions[c].status != SlopeStatus::ok && say_falling(std::move(levels), name));
  }
  return falling;
}

int hierarchical(const HierarchicalCommand& options) {
  HierarchicalResult result;
  result.model = hierarchical_model_of(options);
  result.answers = named_answers(options);
  if (options.bootstrap > 0 && (options.one_jnd || result.answers.conditions.size() < 2))
    throw UsageError("--bootstrap tests one JND for all conditions: it takes several conditions, without --one-jnd");
  if (options.check < 0 || options.check > 10'000) throw UsageError("--check=N: from 1 to 10000 draws");
  if (options.check > 0 && (options.overdispersion || options.drift))
    throw UsageError("--check draws independent answers that do not drift: leave --overdispersion and --drift out");
  const SharedForm others = result.model.estimated;
  SharedForm of_sureness;
  if (result.answers.graded)
    of_sureness = of_sureness.with(SharedParameter::sure_below).with(SharedParameter::sure_above);
  for (const SharedParameter which : kSharedParameters)
    if (of_sureness.has(which)) result.model.estimated = result.model.estimated.with(which);
  const int processors = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const int threads = options.threads > 0 ? options.threads : processors;
  std::optional<WorkLine> working(std::in_place, "fitting " + options.input.file);
  HierarchicalAnalysis analysis(result.answers.cells, result.model);
  const double most_work = options.thorough ? kInf : kCommandWork;
  result.fit = analysis.complete({.intervals = true, .shared = true, .pairs = analysis.pairs(), .most_work = most_work},
                                 threads);
  for (const SharedEstimate& one : result.fit.shared_estimates)
    (of_sureness.has(one.parameter) ? result.sureness : result.shared).push_back(one);
  if (result.answers.graded) result.narrower = narrower_by(result, most_work);
  if (others.any()) {
    HierarchicalModel plain = result.model;
    plain.estimated = of_sureness;
    result.without = HierarchicalAnalysis(result.answers.cells, plain)
                         .complete({.intervals = true, .most_work = most_work}, threads);
  }
  result.lapses = lapses_beside(analysis.cells(), result.model, result.fit.maximum.place);
  if (options.people || options.input.json) result.people = analysis.people();
  if (options.check > 0) {
    HierarchicalModel found = result.model;
    found.shared = result.fit.maximum.shared;
    result.check = predictive_check(analysis.cells(), found, result.fit.maximum.place, options.check, options.seed);
  }
  working.reset();
  result.falling = falling_of(result);
  if (options.bootstrap > 0 && result.fit.df > 0) {
    ProgressBar bar("drawing studies", options.bootstrap);
    result.bootstrap = equality_bootstrap(result.answers.cells, result.model, result.fit, options.bootstrap,
                                          options.seed, threads, [&bar](int done) { bar.update(done); });
  }
  if (options.input.json)
    fmt::print("{}\n", json_line(hierarchical_json(result)));
  else
    fmt::print("{}", hierarchical_text(result));
  return exit_code::kDone;
}

}  // namespace

void add_calc_hierarchical(CommandTree& calc) {
  const auto [command, options] =
      calc.add("hierarchical", "One model of everybody's answers: the group's JND, ratios of conditions, each person's",
               "jnd calc hierarchical answers.csv --task same-different", hierarchical);
  add_input(
      command, options.input,
      "participant, condition, n, k, and delta (the difference, 0 on same trials; k: answers \"different\") or x "
      "(the comparison's level; k: times it was chosen); for k may stand category (1: same sure, 2: same unsure, 3: "
      "different unsure, 4: different sure); with --observer independent also block, where there are several "
      "differences");
  command.add_option("--task", options.task, "what was asked").one_of({"same-different", "which"}).required();
  command
      .add_option(
          "--observer", options.observer,
          "of same-different: decided on the difference (yes-no), on its size (differencing), or by each interval "
          "itself (independent)")
      .one_of({"yes-no", "differencing", "independent"})
      .show_default();
  command
      .add_option("--lapse", options.lapse,
                  "share of trials answered by chance: a number, or shared (estimated, the same for everybody)")
      .show_default();
  command.add_flag("--overdispersion", options.overdispersion,
                   "estimate how much more alike the answers of one person, condition and level are than independent "
                   "ones");
  command.add_flag("--drift", options.drift,
                   "estimate the change from the first half of each person's trials in a condition to the second: "
                   "counts have a column half (1 or 2), rows of --trials stand in the order of the trials");
  command
      .add_option("--random", options.random,
                  "what differs between people, with commas: tu (JND), tv (JND by condition), own_tv (the same, with a "
                  "spread of each condition's own), tw (criterion, PSE), rho (correlation of tu and tw); none")
      .show_default();
  command.add_flag("--one-jnd", options.one_jnd, "one JND for all conditions");
  command.add_flag("--people", options.people, "also each person's JND, beside the one from their answers alone");
  command.add_flag("--thorough", options.thorough,
                   "search for every interval, which may take minutes; otherwise those beyond 2 s are by curvature");
  command
      .add_option("--bootstrap", options.bootstrap,
                  "draw so many studies without a difference between conditions, for the test of one JND")
      .range(0, 100'000)
      .show_default();
  command.add_flag(fmt::format("--check{{{}}}", kPredictiveDraws), options.check,
                   fmt::format("whether the model draws answers like these: a posterior predictive check by {} draws, "
                               "or --check=N",
                               kPredictiveDraws));
  command.add_option("--seed", options.seed, "of the drawn studies and of the check").show_default();
  command.add_option("--threads", options.threads, "drawn studies at a time (default: one a processor)").range(1, 1024);
  add_trial_options(command, options.trials, kHierarchicalUse);
}

}  // namespace jnd
