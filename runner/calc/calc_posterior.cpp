// jnd calc posterior: the levels and estimates of the Bayesian adaptive procedure from the answers given.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "analysis/procedures/posterior.h"
#include "data/fields/number_text.h"
#include "protocols/input/json_reader.h"
#include "protocols/input/read_file.h"
#include "runner/calc/calc.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;
using Align = TextTable::Align;

struct PosteriorOptions {
  std::string file;
  bool json = false;
};

// A configuration file: the procedure, the slots of its trials, and the answers so far.
struct PosteriorRun {
  PosteriorConfiguration configuration;
  std::string slots;            // letters; at least as many as answers
  std::vector<bool> responses;  // "different", or the comparison was chosen
};

// Reads the file part by part; what is wrong goes to diagnostics, all of it at once.
class PosteriorReader {
 public:
  PosteriorReader(const JsonNode& root, const std::string& file) : file_(file), root_(root, diagnostics_, file) {}

  PosteriorRun read() {
    root_.ignore("$schema");
    PosteriorConfiguration& c = run_.configuration;
    c.task = root_.one_of<PosteriorTask>(
        "task", {{"same-different", PosteriorTask::same_different}, {"which", PosteriorTask::which}});
    which_ = c.task == PosteriorTask::which;
    c.utility = root_.one_of<PosteriorUtility>(
        "utility", {{"variance", PosteriorUtility::variance}, {"entropy", PosteriorUtility::entropy}});
    if (which_)
      c.standard = root_.number("standard", {.min = -1e100, .max = 1e100});
    else
      root_.optional_number("standard");  // the differences are from it; the procedure has no use for it
    read_levels();
    read_grid();
    read_prior();
    read_responses();
    read_slots();
    root_.finish();
    if (diagnostics_.empty())
      if (const std::string problem = problem_of(c); !problem.empty())
        root_.error(root_.node(), problem, "see the help: jnd calc posterior --help");
    if (!diagnostics_.empty()) throw InputError(diagnostics_);
    return run_;
  }

 private:
  const char* shift_key() const { return which_ ? "pse_offset" : "k"; }

  std::vector<double> numbers(const JsonNode* list, const NumberLimits& limits) {
    std::vector<double> values;
    if (list == nullptr) return values;
    for (const JsonNode& item : list->items)
      if (const auto value = number_of(item, limits, diagnostics_, file_)) values.push_back(*value);
    return values;
  }

  // Numbers that each stand once, ascending where `ascending`; the second of two is named.
  void check_order(const JsonNode* list, bool ascending, const char* what) {
    if (list == nullptr || !is_sound(diagnostics_, list->path)) return;
    for (std::size_t i = 1; i < list->items.size(); ++i) {
      const JsonNode& item = list->items[i];
      const auto before = list->items.begin() + static_cast<std::ptrdiff_t>(i);
      if (ascending && item.number <= list->items[i - 1].number) {
        root_.error(item,
                    fmt::format("{} does not come after {}", plain(item.number), plain(list->items[i - 1].number)),
                    fmt::format("{} ascend, and each stands once", what));
        return;
      }
      if (std::any_of(list->items.begin(), before, [&](const JsonNode& one) { return one.number == item.number; })) {
        root_.error(item, plain(item.number) + " stands twice",
                    std::string("every one of the ") + what + " stands once");
        return;
      }
    }
  }

  void read_levels() {
    const JsonNode* list = root_.array("levels", 2, 1000);
    const NumberLimits limits =
        which_ ? NumberLimits{.min = -1e100, .max = 1e100} : NumberLimits{.min = 0, .max = 1e100};
    run_.configuration.levels = numbers(list, limits);
    check_order(list, false, "levels");
    if (list != nullptr && !which_ && is_sound(diagnostics_, list->path) && list->items.front().number != 0)
      root_.error(list->items.front(), plain(list->items.front().number) + " is no same trial",
                  "levels of same-different are differences, and the first of them is 0: the same trial");
  }

  void read_grid() {
    const JsonNode* grid = root_.object("grid");
    if (grid == nullptr) return;
    JsonReader part(*grid, diagnostics_, file_);
    PosteriorConfiguration& c = run_.configuration;
    const JsonNode* ln_s = part.array("ln_s", 1, 10000);
    c.ln_s = numbers(ln_s, {.min = -100, .max = 100});
    check_order(ln_s, true, "values of ln_s");
    const JsonNode* shift = part.array(shift_key(), 1, 10000);
    c.shift = numbers(shift, {.min = -1e100, .max = 1e100});
    check_order(shift, false, which_ ? "values of pse_offset" : "values of k");
    const JsonNode* lapse = part.array("lapse", 1, 1000);
    c.lapse = numbers(lapse, {.min = 0, .max = 0.999});
    check_order(lapse, false, "lapses");
    part.finish();
  }

  PosteriorPrior read_gaussian(JsonReader& prior, const char* key) {
    const JsonNode* list = prior.array(key, 2, 2);
    if (list == nullptr) return {};
    const auto mean = number_of(list->items[0], {.min = -1e100, .max = 1e100}, diagnostics_, file_);
    const auto sd = number_of(list->items[1], {.min = 0, .max = 1e100, .above = true}, diagnostics_, file_);
    return {mean.value_or(0), sd.value_or(1)};
  }

  void read_prior() {
    const JsonNode* prior = root_.object("prior");
    if (prior == nullptr) return;
    JsonReader part(*prior, diagnostics_, file_);
    PosteriorConfiguration& c = run_.configuration;
    c.ln_s_prior = read_gaussian(part, "ln_s");
    c.shift_prior = read_gaussian(part, shift_key());
    const JsonNode* weights = part.array("lapse", 1, 1000);
    c.lapse_weights = numbers(weights, {.min = 0, .max = 1e100});
    if (weights != nullptr && is_sound(diagnostics_, weights->path) && is_sound(diagnostics_, "$.grid.lapse") &&
        c.lapse_weights.size() != c.lapse.size())
      part.error(*weights, fmt::format("{} weights for {} lapses", c.lapse_weights.size(), c.lapse.size()),
                 "give one weight for each lapse of the grid");
    part.finish();
  }

  void read_responses() {
    const JsonNode* list = root_.array("responses", 0, 10000);
    if (list == nullptr) return;
    for (const JsonNode& item : list->items)
      if (const auto answer = integer_of(item, {.min = 0, .max = 1}, diagnostics_, file_))
        run_.responses.push_back(*answer == 1);
  }

  // Without slots every trial is free.
  void read_slots() {
    run_.slots = std::string(run_.responses.size(), 'F');
    const JsonNode* node = root_.member("slots");
    if (node == nullptr || node->kind == JsonNode::Kind::null) return;
    const auto slots = text_of(*node, {.max_length = 10000, .may_be_empty = true}, diagnostics_, file_);
    if (!slots) return;
    for (std::size_t t = 0; t < slots->size(); ++t) {
      if (!posterior_slot_from((*slots)[t], run_.configuration.task)) {
        root_.error(*node, fmt::format("trial {}: {} is no slot", t + 1, in_quotes(std::string(1, (*slots)[t]))),
                    which_ ? "F: any level, L: below the standard, U: above it, B: balanced"
                           : "S: a same trial, D: a different one, F: free");
        return;
      }
    }
    if (slots->size() < run_.responses.size())
      root_.error(*node, fmt::format("{} slots for {} responses", slots->size(), run_.responses.size()),
                  "one letter for each trial; letters beyond the responses are trials to come");
    check_sides(*node, *slots);
    run_.slots = *slots;
  }

  // Slots on one side of the standard need a level there.
  void check_sides(const JsonNode& node, const std::string& slots) {
    if (!which_ || !is_sound(diagnostics_, "$.levels") || !is_sound(diagnostics_, "$.standard")) return;
    const PosteriorConfiguration& c = run_.configuration;
    const auto any = [&](auto is) { return std::any_of(c.levels.begin(), c.levels.end(), is); };
    const bool below = any([&](double level) { return level < c.standard; });
    const bool above = any([&](double level) { return level > c.standard; });
    if (!below && slots.find_first_of("LB") != std::string::npos)
      root_.error(node, "slots L and B need a level below the standard", "add one, or use F and U");
    if (!above && slots.find_first_of("UB") != std::string::npos)
      root_.error(node, "slots U and B need a level above the standard", "add one, or use F and L");
  }

  std::string file_;
  std::vector<Diagnostic> diagnostics_;
  JsonReader root_;
  PosteriorRun run_;
  bool which_ = false;
};

// Of the posterior; names with k for same-different, with a (the PSE's distance from the standard) for which.
void add_estimate(Json& out, const PosteriorEstimate& of, bool which) {
  out["mean_ln_s"] = json_number(of.mean_ln_s);
  out["sd_ln_s"] = json_number(of.sd_ln_s);
  out[which ? "s_geomean" : "jnd_geomean"] = json_number(std::exp(of.mean_ln_s));
  out[which ? "mean_a" : "mean_k"] = json_number(of.mean_shift);
  out[which ? "sd_a" : "sd_k"] = json_number(of.sd_shift);
  out["mean_lapse"] = json_number(of.mean_lapse);
}

struct PosteriorTrial {
  PosteriorChoice choice;
  bool positive = false;
  PosteriorEstimate after;
};

struct PosteriorReplay {
  PosteriorEstimate before;
  std::vector<PosteriorTrial> trials;
  std::vector<PosteriorChoice> next;  // one where the slots go on
};

PosteriorReplay replay(const PosteriorRun& run) {
  PosteriorProcedure procedure(run.configuration);
  PosteriorReplay done;
  done.before = procedure.estimate();
  const auto slot = [&](std::size_t t) { return *posterior_slot_from(run.slots[t], run.configuration.task); };
  for (std::size_t t = 0; t < run.responses.size(); ++t) {
    const PosteriorChoice choice = procedure.choose(slot(t));
    procedure.update(choice.level, run.responses[t]);
    done.trials.push_back({choice, run.responses[t], procedure.estimate()});
  }
  if (run.slots.size() > run.responses.size()) done.next.push_back(procedure.choose(slot(run.responses.size())));
  return done;
}

Json posterior_json(const PosteriorRun& run, const PosteriorReplay& done) {
  const bool which = run.configuration.task == PosteriorTask::which;
  const std::vector<double>& levels = run.configuration.levels;
  Json out = {{"task", which ? "which" : "same-different"}, {"prior_stats", Json::object()}, {"trials", Json::array()}};
  add_estimate(out["prior_stats"], done.before, which);
  for (std::size_t t = 0; t < done.trials.size(); ++t) {
    const PosteriorTrial& trial = done.trials[t];
    Json line = {{"trial", t + 1}};
    if (!which) line["type"] = trial.choice.level == 0 ? "same" : "different";
    line["level"] = json_number(levels[trial.choice.level]);
    if (which)
      line["response"] = trial.positive ? 1 : 0;
    else
      line["response"] = trial.positive ? "different" : "same";
    line["utility"] = json_number(trial.choice.utility);
    add_estimate(line, trial.after, which);
    out["trials"].push_back(std::move(line));
  }
  out["final"] = done.trials.empty() ? Json(nullptr) : out["trials"].back();
  out["next"] = nullptr;
  if (!done.next.empty())
    out["next"] = {{"level", json_number(levels[done.next[0].level])}, {"utility", json_number(done.next[0].utility)}};
  return out;
}

std::string posterior_text(const PosteriorRun& run, const PosteriorReplay& done) {
  const bool which = run.configuration.task == PosteriorTask::which;
  const double zero = which ? run.configuration.standard : 0;
  TextTable table(
      {"trial", "level", "answer", "utility", which ? "s" : "JND", "SD of ln s", which ? "PSE" : "k", "lapse"},
      {Align::right, Align::right, Align::left, Align::right, Align::right, Align::right, Align::right, Align::right});
  const auto number = [](double value) { return number_text(value, decimals_of_size(std::abs(value))); };
  const auto add = [&](const std::string& trial, const std::string& level, const std::string& answer,
                       const std::string& utility, const PosteriorEstimate& of) {
    table.add({trial, level, answer, utility, number(std::exp(of.mean_ln_s)), number(of.sd_ln_s),
               number(zero + of.mean_shift), number(of.mean_lapse)});
  };
  add("prior", "", "", "", done.before);
  for (std::size_t t = 0; t < done.trials.size(); ++t) {
    const PosteriorTrial& trial = done.trials[t];
    const char* answer = which ? (trial.positive ? "comparison" : "standard") : (trial.positive ? "different" : "same");
    add(std::to_string(t + 1), fmt::format("{:g}", run.configuration.levels[trial.choice.level]), answer,
        number(trial.choice.utility), trial.after);
  }
  std::string text = table.text();
  if (!done.next.empty()) text += fmt::format("next level {:g}\n", run.configuration.levels[done.next[0].level]);
  return text;
}

int posterior(const PosteriorOptions& options) {
  const bool piped = options.file == "-";
  const std::string name = piped ? "standard input" : options.file;
  JsonNode root = parse_json(piped ? read_standard_input() : read_input_file(options.file), name);
  round_numbers(root);
  const PosteriorRun run = PosteriorReader(root, name).read();
  const PosteriorReplay done = replay(run);
  if (options.json)
    print_json(posterior_json(run, done));
  else
    fmt::print("{}", posterior_text(run, done));
  return exit_code::kDone;
}

const std::string kPosteriorFile =
    "The file is one JSON object:\n"
    "  task       same-different, or which (2IFC: which is stiffer?)\n"
    "  standard   of which, in the unit of the levels\n"
    "  levels     same-different: differences, the first of them 0 (a same trial); which: comparisons\n"
    "  grid       ln_s, k (which: pse_offset) and lapse: a list of values each\n"
    "  prior      ln_s and k (pse_offset): [mean, SD] each; lapse: a weight for each lapse\n"
    "  utility    variance (of ln s) or entropy\n"
    "  slots      a letter a trial: S, D, F (same, different, free); which: F, L, U, B (any, below, above, balanced).\n"
    "             Without it every trial is free. One letter more than responses asks for the next level.\n"
    "  responses  0 and 1; 1: \"different\", or the comparison was chosen\n\n";

}  // namespace

void add_calc_posterior(CommandTree& calc) {
  const auto [command, options] =
      calc.add("posterior", "Levels and estimates of the Bayesian adaptive procedure (Kontsevich & Tyler 1999)",
               "jnd calc posterior run.json --json", posterior);
  command.add_option("FILE", options.file, "a configuration with its answers; - reads standard input").required();
  command.add_flag("--json", options.json, "machine-readable");
  command.add_notes(kPosteriorFile);
}

}  // namespace jnd
