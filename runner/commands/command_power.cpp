// jnd plan --power: how often a study will find what is there.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <thread>

#include <fmt/format.h>

#include "data/files/draft.h"
#include "protocols/input/input_error.h"
#include "protocols/input/resources.h"
#include "protocols/planning/allotment.h"
#include "protocols/tasks/level_source.h"
#include "protocols/tasks/task.h"
#include "runner/commands/commands.h"
#include "runner/commands/power_options.h"
#include "runner/keys/interrupt.h"
#include "runner/opening/study_access.h"
#include "runner/power/power_figure.h"
#include "runner/power/power_shard.h"
#include "runner/power/power_study.h"
#include "runner/power/power_text.h"
#include "runner/session/simulate.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/progress_bar.h"
#include "runner/terminal/standard_streams.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

constexpr int kMostStudies = 100'000'000;

void write_new(const std::string& file, const std::string& text) {
  if (file.empty()) return;
  Draft draft(file, Draft::What::file, Draft::Access::everyone);
  draft.write(text);
  if (!draft.publish()) throw InputError(fmt::format("{}: is there already (give another name)", printable(file)));
}

int threads_of(const PowerOptions& options) {
  return options.threads > 0 ? options.threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

std::vector<PowerAnalysis> analyses_of(const PowerOptions& options, const Protocol& protocol) {
  std::vector<PowerAnalysis> analyses;
  for (const std::string& word : options.analyses) {
    const PowerAnalysis analysis = value_of(kPowerAnalysisWords, word).value();
    if (const std::string why = power_refusal(analysis, protocol); !why.empty())
      throw UsageError(fmt::format("--analysis {}: {}", word, why));
    if (std::find(analyses.begin(), analyses.end(), analysis) == analyses.end()) analyses.push_back(analysis);
  }
  if (!options.analyses.empty()) return analyses;
  for (const PowerAnalysis analysis : {PowerAnalysis::registered, PowerAnalysis::hierarchical}) {
    const std::string why = power_refusal(analysis, protocol);
    if (why.empty())
      analyses.push_back(analysis);
    else
      write_marked_message(fmt::format("{} is left out: {}", word_of(kPowerAnalysisWords, analysis), why));
  }
  if (analyses.empty()) throw UsageError(power_refusal(PowerAnalysis::hierarchical, protocol));
  return analyses;
}

void refuse_protocol(const Protocol& protocol, const std::string& name) {
  if (!response_model_of(protocol))
    throw UsageError(fmt::format(
        "{}: power is offered for \"same-different\" with yes-no or differencing d', for \"which\" and for \"yes-no\"; this "
        "study has {}",
        printable(name), task_of(protocol.task.kind).without_model(protocol)));
  if (protocol.conditions.size() < 2 && registered_group_tests(protocol).empty())
    throw UsageError(fmt::format("{}: one condition has nothing to be compared with", printable(name)));
}

// Cells of a design that is balanced need a multiple of the arrangements.
void refuse_trials(const std::vector<int>& trials, const Protocol& protocol) {
  if (!levels_given(protocol)) {
    if (!trials.empty()) throw UsageError("--trials: a procedure says itself when its tracks end");
    return;
  }
  const int balance = task_of(protocol.task.kind).balance_of(protocol.task);
  for (const int one : trials)
    if (protocol.design.sampling == Sampling::balanced && one % balance != 0)
      throw UsageError(fmt::format("--trials {}: balanced cells need a multiple of {}", one, balance));
}

// Groups are of one size.
void refuse_participants(const std::vector<int>& participants, const Protocol& protocol) {
  const int groups = group_count(protocol);
  for (const int one : participants)
    if (one % groups != 0)
      throw UsageError(
          fmt::format("--participants {}: {} groups of one size need a multiple of {}", one, groups, groups));
}

// As the arguments of --group-factor have them: "patients=1.4", "patients/V=1.4". By group, then condition.
std::vector<std::vector<double>> group_factors(const std::vector<std::string>& arguments, const Protocol& protocol) {
  if (protocol.groups.empty() && !arguments.empty()) throw UsageError("--group-factor: the protocol has no groups");
  std::vector<std::vector<double>> factors(protocol.groups.size(), std::vector<double>(protocol.conditions.size(), 1));
  for (const std::string& argument : arguments) {
    const auto fail = [&](const std::string& why) {
      return UsageError(fmt::format("--group-factor {}: {}", printable(argument), why));
    };
    const std::size_t equals = std::min(argument.find('='), argument.size()), slash = argument.find('/');
    const std::string group = argument.substr(0, std::min(slash, equals));
    double factor = 0;
    const char* const begin = argument.data() + std::min(equals + 1, argument.size());
    const char* const end = argument.data() + argument.size();
    const auto [rest, error] = std::from_chars(begin, end, factor);
    if (error != std::errc() || rest != end || !(factor >= 0.01 && factor <= 100))
      throw fail("GROUP=FACTOR, or GROUP/CONDITION=FACTOR, with a factor from 0.01 to 100");
    const std::optional<int> place = group_named(protocol, group);
    if (!place) throw fail(fmt::format("the protocol has the groups {}", fmt::join(group_names(protocol), ", ")));
    std::vector<double>& of_group = factors[static_cast<std::size_t>(*place)];
    if (slash >= equals) {
      of_group.assign(of_group.size(), factor);
      continue;
    }
    const std::string condition = argument.substr(slash + 1, equals - slash - 1);
    bool found = false;
    for (const int c : conditions_of(protocol, place)) {
      if (condition_name(protocol, c) != condition) continue;
      of_group[static_cast<std::size_t>(c)] = factor;
      found = true;
    }
    if (!found) throw fail(fmt::format("the group {} has no such condition", group));
  }
  return factors;
}

template <typename Value>
std::vector<Value> in_order(std::vector<Value> values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

PowerQuestion question_of(const Protocol& protocol, std::uint64_t seed, const PrecisionOptions& precision,
                          const PowerOptions& options) {
  PowerQuestion question;
  question.participants = in_order(precision.participants);
  if (question.participants.empty()) question.participants = {protocol.design.participants};
  question.trials = in_order(precision.trials);
  if (question.trials.empty() && levels_given(protocol)) question.trials = {protocol.design.trials_per_cell};
  question.effects = in_order(options.effects);
  if (question.effects.empty()) question.effects = options.physics ? std::vector{1.0} : std::vector{0.0, 1.0};
  for (const PlannedJnd& jnd : asked_jnds(precision.jnds, protocol)) question.jnds.push_back(jnd.value);
  for (const Contrast& contrast : protocol.analysis.contrasts) question.contrasts.push_back({contrast.a, contrast.b});
  question.group_tests = registered_group_tests(protocol);
  question.group_factors = group_factors(options.group_factors, protocol);
  question.people.between_cv = precision.between_cv.value_or(question.people.between_cv);
  question.people.interaction_cv = options.interaction_cv.value_or(question.people.interaction_cv);
  question.people.criterion = options.criterion.value_or(usual_criterion(response_model_of(protocol).value()));
  question.people.criterion_sd = options.criterion_sd.value_or(question.people.criterion_sd);
  question.people.lapse = options.lapses;
  question.people.drop_out = options.drop_out;
  question.analyses = analyses_of(options, protocol);
  question.studies = options.studies;
  question.seed = seed;
  question.wanted = options.wanted;
  if (options.physics) {
    question.profile = options.profile.empty() ? default_profile(protocol) : options.profile;
    question.simulation_sha256 = simulation_sha256(protocol, rig_of(protocol),
                                                   load_profile(find_resource(Resource::profile, *question.profile)));
  }
  return question;
}

void refuse_question(const PowerQuestion& question, const PrecisionOptions& precision, const PowerOptions& options,
                     const Protocol& protocol) {
  if (!options.physics) {
    if (!options.profile.empty()) throw UsageError("--profile goes with --physics");
    const bool equal = std::all_of(question.jnds.begin(), question.jnds.end(),
                                   [&](double jnd) { return jnd == question.jnds.front(); });
    const bool groups_differ =
        std::any_of(question.group_factors.begin(), question.group_factors.end(), [](const auto& of_group) {
          return std::any_of(of_group.begin(), of_group.end(), [](double factor) { return factor != 1; });
        });
    if (equal && !groups_differ &&
        std::any_of(question.effects.begin(), question.effects.end(), [](double effect) { return effect != 0; }))
      throw UsageError(fmt::format(
          "all conditions are planned with the JND {:g}, so that there is nothing to find: give --jnd "
          "{}=NUMBER{}, or --effect 0 for the rate of false findings",
          question.jnds.front(), protocol.conditions.front().name,
          protocol.groups.empty() ? "" : fmt::format(", --group-factor {}=NUMBER", protocol.groups.front().name)));
    return;
  }
  if (!options.effects.empty() || !precision.jnds.empty() || precision.between_cv || options.interaction_cv ||
      options.criterion || options.criterion_sd || options.lapses > 0 || !options.group_factors.empty())
    throw UsageError(
        "--physics: what participants feel and answer follows from the rig and the profile; --effect, --jnd, "
        "--between-cv, --interaction-cv, --criterion, --criterion-sd, --lapses and --group-factor do not go with it");
}

// Every pair, where the protocol registers none: tested as contrasts are.
void add_contrasts(Protocol& protocol) {
  if (!protocol.analysis.contrasts.empty()) return;
  const int conditions = static_cast<int>(protocol.conditions.size());
  for (int a = 0; a < conditions; ++a)
    for (int b = a + 1; b < conditions; ++b)
      if (anyone_has_both(protocol, a, b)) protocol.analysis.contrasts.push_back({a, b});
}

}  // namespace

void add_power_files(const Command& command, PowerFiles& files, const std::string& csv) {
  command.add_option("--csv", files.csv, csv);
  command.add_option("--figure", files.figure, "also curves of power over the designs, as an SVG picture");
  command.add_option("--ademp", files.ademp,
                     "also the plan of the simulation in Markdown: aims, data, estimands, methods, performance");
}

void refuse_existing(const PowerFiles& files) {
  for (const std::string& file : {files.csv, files.ademp, files.figure})
    if (!file.empty() && std::filesystem::exists(file))
      throw InputError(fmt::format("{}: is there already (give another name)", printable(file)));
}

void give_power_result(const PowerResult& result, const PowerFiles& files, bool json) {
  write_new(files.csv, power_csv(result));
  write_new(files.ademp, ademp_text(result));
  if (!files.figure.empty()) write_new(files.figure, power_figure(result).file());
  if (json)
    print_json(power_json(result));
  else
    fmt::print("{}", power_text(result));
}

void add_power_options(const Command& plan, PowerOptions& options) {
  const CommandOption power = plan.add_flag(
      "--power", options.asked, "how often such a study finds what is there, and how precisely, by simulating it");
  const auto add = [&](CommandOption option) { return option.needs(power); };
  add(plan.add_option("--effect", options.effects,
                      "how far apart the true JNDs are: 0 not at all, 1 as planned (default: 0,1)"))
      .range(0.0, 10.0)
      .delimiter(',');
  add(plan.add_option("--group-factor", options.group_factors,
                      "how many times as large the true JNDs of a group of participants are: patients=1.4; in one "
                      "condition: patients/V=1.4 (default: 1)"))
      .delimiter(',');
  add(plan.add_option("--analysis", options.analyses, "how studies are analysed (default: registered,hierarchical)"))
      .one_of({"registered", "median", "log-ml", "hierarchical"})
      .delimiter(',');
  add(plan.add_option("--interaction-cv", options.interaction_cv,
                      "spread of what a condition adds to a person's JND (default: 0.15)"))
      .range(0.0, 2.0);
  add(plan.add_option("--criterion", options.criterion,
                      "mean criterion: of d' where \"different\" begins; of choices the bias, in JNDs (default: 0.75; "
                      "differencing, ln tau: 0.5; choices: 0)"))
      .range(-5.0, 5.0);
  add(plan.add_option("--criterion-sd", options.criterion_sd, "its spread between people (default: 0.3)"))
      .range(0.0, 5.0);
  add(plan.add_option("--lapses", options.lapses, "share of trials answered by a guess (default: 0)")).range(0.0, 0.9);
  add(plan.add_option("--drop-out", options.drop_out, "share of participants who leave nothing (default: 0)"))
      .range(0.0, 0.9);
  add(plan.add_option("--studies", options.studies, "how many are simulated of each design (default: 1000)"))
      .range(1, kMostStudies);
  add(plan.add_option("--wanted", options.wanted, "the power that the smallest design is to have (default: 0.8)"))
      .range(0.01, 0.999);
  add(plan.add_flag("--physics", options.physics,
                    "participants go through the simulated rig at 1 kHz, instead of answering by the response model"));
  add(plan.add_option("--profile", options.profile, "with --physics: profile file, or name of a shipped one"));
  add(plan.add_option("--threads", options.threads, "studies at a time (default: one a processor)")).range(1, 1024);
  add_shard_options(plan, options.shard, "--power");
  add_power_files(plan, options.files, "also all numbers of the power study as a CSV file, a row each");
  for (const char* const name : {"--csv", "--figure", "--ademp"})
    plan.option(name).needs(power).excludes(plan.option("--to"));
}

int plan_power(const std::string& name, std::uint64_t seed, bool json, const PrecisionOptions& precision,
               const PowerOptions& options) {
  const ShardPlace place = place_of(options.shard);
  Protocol protocol = load_checked_protocol(name);
  refuse_protocol(protocol, name);
  refuse_trials(precision.trials, protocol);
  refuse_participants(precision.participants, protocol);
  add_contrasts(protocol);
  const PowerQuestion question = question_of(protocol, seed, precision, options);
  refuse_question(question, precision, options, protocol);
  refuse_existing(options.files);
  if (!options.shard.to.empty())
    return make_shard_file(power_shard(protocol, question, place.number, place.of),
                           power_work(protocol, question, threads_of(options)), options.shard);
  const HoldInterrupts hold;
  std::optional<ProgressBar> bar(std::in_place, "simulating studies", question.studies);
  PowerResult result{protocol, question,
                     power_study(protocol, question, {0, question.studies}, threads_of(options),
                                 [&bar](std::int64_t done) { bar->update(done); })};
  bar.reset();
  give_power_result(result, options.files, json);
  return exit_code::kDone;
}

}  // namespace jnd
