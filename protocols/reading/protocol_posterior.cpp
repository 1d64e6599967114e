// Reads what the Bayesian procedure and the posterior of all answers need: levels, utility, grid and prior.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "protocols/reading/protocol_reading.h"
#include "protocols/tasks/posterior_model.h"

namespace jnd {
namespace {

// So many probabilities are looked through for every level that is chosen: less than a millisecond.
constexpr std::size_t kMostCellsOfChoice = 500'000;

struct Sizes {
  std::size_t least = 1, most = 1;  // of a list
};

void require_ascending(const JsonNode& list, ProtocolReading& reading) {
  for (std::size_t i = 1; i < list.items.size(); ++i) {
    if (list.items[i].number > list.items[i - 1].number) continue;
    reading.error(
        list.items[i],
        fmt::format("{} does not come after {}", plain(list.items[i].number), plain(list.items[i - 1].number)),
        "the values ascend, and each stands once");
    return;
  }
}

std::vector<double> read_list(const JsonNode* list, const NumberLimits& limits, ProtocolReading& reading) {
  std::vector<double> values;
  if (list == nullptr) return values;
  for (const JsonNode& item : list->items)
    values.push_back(number_of(item, limits, reading.errors, reading.file).value_or(0));
  return values;
}

// A list, or from, to and step; empty where it is missing.
std::vector<double> read_values(JsonReader& reader, std::string_view key, bool required, Sizes sizes,
                                const NumberLimits& limits, ProtocolReading& reading) {
  const JsonNode* given = reader.member(key);
  if (given != nullptr && given->kind == JsonNode::Kind::object) {
    std::vector<double> steps = read_steps(*given, limits, reading);
    if (reading.sound(given->path) && steps.size() < sizes.least)
      reading.error(*given, fmt::format("{} values are too few", steps.size()),
                    fmt::format("give {} or more", sizes.least));
    return steps;
  }
  const JsonNode* list =
      required ? reader.array(key, sizes.least, sizes.most) : reader.array_or_null(key, sizes.least, sizes.most);
  std::vector<double> values = read_list(list, limits, reading);
  if (list != nullptr && reading.sound(list->path)) require_ascending(*list, reading);
  return values;
}

// [mean, SD]; an SD of 0 where it is missing.
PosteriorPrior read_gaussian(JsonReader& prior, std::string_view key, ProtocolReading& reading) {
  const JsonNode* list = prior.array_or_null(key, 2, 2);
  if (list == nullptr || list->items.size() != 2) return {0, 0};
  const auto mean = number_of(list->items[0], {.min = -1e9, .max = 1e9}, reading.errors, reading.file);
  const auto sd = number_of(list->items[1], {.min = 0, .max = 1e9, .above = true}, reading.errors, reading.file);
  return {mean.value_or(0), sd.value_or(1)};
}

// The model's shift has another meaning, and name, in either of the models.
struct ShiftKeys {
  std::string_view own, other;
};
ShiftKeys shift_keys(const ProtocolReading& reading) {
  const bool which = reading.task().posterior_task() == PosteriorTask::which;
  return which ? ShiftKeys{"pse_offset", "k"} : ShiftKeys{"k", "pse_offset"};
}

void refuse_other_shift(JsonReader& reader, const ShiftKeys& keys) {
  if (reader.member(keys.other) != nullptr)
    reader.error(keys.other, "is not a parameter of this task's response model",
                 fmt::format("write {}", in_quotes(keys.own)));
}

void read_grid(const JsonNode& node, PosteriorConfiguration& given, ProtocolReading& reading) {
  JsonReader reader(node, reading.errors, reading.file);
  const ShiftKeys keys = shift_keys(reading);
  given.ln_s = read_values(reader, "ln_s", false, {5, 200}, {.min = -100, .max = 100}, reading);
  given.shift = read_values(reader, keys.own, false, {1, 200}, {.min = -1e9, .max = 1e9}, reading);
  refuse_other_shift(reader, keys);
  given.lapse = read_values(reader, "lapse", false, {1, 20}, {.min = 0, .max = 0.5}, reading);
  reader.finish();
}

void read_prior(const JsonNode& node, PosteriorConfiguration& given, ProtocolReading& reading) {
  JsonReader reader(node, reading.errors, reading.file);
  const ShiftKeys keys = shift_keys(reading);
  given.ln_s_prior = read_gaussian(reader, "ln_s", reading);
  given.shift_prior = read_gaussian(reader, keys.own, reading);
  refuse_other_shift(reader, keys);
  given.lapse_weights = read_list(reader.array_or_null("lapse", 1, 20), {.min = 0, .max = 1e9}, reading);
  reader.finish();
}

// A choice looks through all probabilities, and every track keeps them; they are as many in every series.
bool look_at_size(const AdaptiveProcedure& procedure, ProtocolReading& reading) {
  const Protocol& protocol = reading.protocol;
  const PosteriorConfiguration c = posterior_model(protocol, protocol.series.front()).configuration;
  const std::size_t observers = c.ln_s.size() * c.shift.size() * c.lapse.size();
  const std::size_t cells = c.levels.size() * observers;
  const std::size_t tracks = protocol.series.size() * protocol.conditions.size();
  if (cells > kMostCellsOfChoice)
    reading.error_at(
        limits_path(procedure),
        fmt::format("{} levels for {} observers of the grid: a choice takes too long", c.levels.size(), observers),
        fmt::format("levels times observers are at most {}: fewer levels, or a coarser grid", kMostCellsOfChoice));
  else if (cells * tracks > kMostPosteriorCells)
    reading.error_at(
        limits_path(procedure),
        fmt::format("{} tracks with {} probabilities each are more than {}", tracks, cells, kMostPosteriorCells),
        "take fewer levels, or a coarser grid");
  else
    return true;
  return false;
}

// Whether the levels of one series, its grid and its prior make a model; says so where they do not.
bool look_at_model(const JsonNode& node, const Series& series, const AdaptiveProcedure& procedure,
                   ProtocolReading& reading) {
  if (!(series.standard > 0) && !names_whole_model(procedure.posterior)) {
    reading.error(node,
                  fmt::format("the default grid and prior grow with the standard, and {} is {}", series.name,
                              plain(series.standard)),
                  "give ln_s and the shift in \"grid\" and in \"prior\"");
    return false;
  }
  const PosteriorConfiguration c = posterior_model(reading.protocol, series).configuration;
  if (c.lapse.size() != c.lapse_weights.size()) {
    reading.error_at(procedure_path(procedure.posterior.lapse.empty() ? "prior.lapse" : "grid.lapse"),
                     fmt::format("{} lapses and {} weights", c.lapse.size(), c.lapse_weights.size()),
                     "give one weight of \"prior\" for each lapse of \"grid\"");
    return false;
  }
  if (const std::string problem = problem_of(c); !problem.empty()) {
    reading.error(node, problem, "change the grid or the prior");
    return false;
  }
  PosteriorConfiguration prior = c;
  prior.levels.clear();  // no tables
  const double prior_sd = PosteriorProcedure(prior).estimate().sd_ln_s;
  if (procedure.precision && *procedure.precision >= prior_sd) {
    reading.error_at(procedure_path("stop.precision"),
                     fmt::format("{} is reached before the first answer: the prior has a standard deviation of {:.3g}",
                                 plain(*procedure.precision), prior_sd),
                     "take a smaller one, such as 0.2");
    return false;
  }
  return true;
}

}  // namespace

std::string limits_path(const AdaptiveProcedure& procedure) {
  return procedure_path(procedure.kind == AdaptiveProcedure::Kind::posterior ? "levels" : "clamp");
}

void read_posterior(JsonReader& reader, AdaptiveProcedure& procedure, ProtocolReading& reading) {
  reader.refuse({"starts", "clamp"}, "has no meaning in a posterior procedure, which chooses among its levels",
                "remove it");
  const NumberLimits limits{.min = 0, .max = 20000, .above = true, .unit = to_string(reading.protocol.stimulus.unit)};
  std::vector<double>& levels = procedure.posterior.levels;
  levels = read_values(reader, "levels", true, {2, 50}, limits, reading);
  procedure.posterior.utility = reader.one_of_or<PosteriorUtility>(
      "utility", {{"variance", PosteriorUtility::variance}, {"entropy", PosteriorUtility::entropy}},
      PosteriorUtility::variance);
  if (levels.empty()) return;
  procedure.clamp = {levels.front(), levels.back()};
  procedure.starts = {levels.back()};
}

void read_response_model(JsonReader& reader, AdaptiveProcedure& procedure, ProtocolReading& reading) {
  PosteriorConfiguration& given = procedure.posterior;
  given.ln_s_prior.sd = given.shift_prior.sd = 0;  // not given
  if (const JsonNode* grid = reader.object_or_null("grid")) read_grid(*grid, given, reading);
  if (const JsonNode* prior = reader.object_or_null("prior")) read_prior(*prior, given, reading);
}

void lint_response_model(const JsonNode& node, const AdaptiveProcedure& procedure, ProtocolReading& reading) {
  const Protocol& protocol = reading.protocol;
  if (!reading.sound(node.path) || !reading.sound("$.standards") || !reading.sound("$.stimulus") ||
      !reading.task().posterior_task())
    return;
  if (protocol.series.empty() || !look_at_size(procedure, reading)) return;
  for (const Series& series : protocol.series)
    if (!look_at_model(node, series, procedure, reading)) return;
}

void warn_about_response_model(const AdaptiveProcedure& procedure, ProtocolReading& reading) {
  const Protocol& protocol = reading.protocol;
  for (const Series& series : protocol.series) {
    const double expected = std::exp(posterior_model(protocol, series).configuration.ln_s_prior.mean);
    if (procedure.clamp[1] >= expected) continue;
    reading.warn_at(limits_path(procedure),
                    fmt::format("the largest level, {}, is below the JND that the prior expects, {:.4g}",
                                plain(procedure.clamp[1]), expected),
                    "add larger levels, or say in \"prior\" what is expected");
    return;
  }
}

}  // namespace jnd
