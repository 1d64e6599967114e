// Contradictions between the sections of a protocol, and designs that cannot be carried out: all of them are errors.
#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "protocols/planning/allotment.h"
#include "protocols/reading/protocol_reading.h"
#include "protocols/tasks/task.h"

namespace jnd {
namespace {

// Beyond this the counts of sequences in a block leave the range of double (protocols/planning/order.h).
constexpr int kMostTrialsOfLimitedBlock = 1000;
constexpr int kMostTrialsOfSession = 10000;
constexpr std::size_t kMostPermuted = 8;  // 8! = 40320 orders
constexpr std::size_t kMostWilliams = 50;

std::string element(std::string_view list, std::size_t place, std::string_view member) {
  return fmt::format("$.{}[{}].{}", list, place, member);
}

void lint_names(ProtocolReading& reading) {
  const auto look = [&](const auto& all, std::string_view list, std::string_view what) {
    std::map<std::string, std::size_t> first;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].name.empty()) continue;
      const auto [known, is_new] = first.emplace(all[i].name, i);
      if (!is_new)
        reading.error_at(element(list, i, "name"),
                         fmt::format("there are two {} named {}", what, in_quotes(all[i].name)),
                         "names must differ: draws and results are keyed by them");
    }
  };
  look(reading.protocol.conditions, "conditions", "conditions");
  look(reading.protocol.series, "series", "series");
  look(reading.protocol.groups, "groups", "groups");
}

// That one participant gets: of groups, the most.
std::size_t most_conditions(const Protocol& protocol) {
  return conditions_of(protocol, largest_plan(protocol)).size();
}

void lint_conditions(ProtocolReading& reading) {
  const auto& conditions = reading.protocol.conditions;
  for (std::size_t i = 1; i < conditions.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const bool readable =
          reading.sound(element("conditions", i, "cues")) && reading.sound(element("conditions", j, "cues"));
      if (readable && reading.protocol.rig.built_in() && conditions[i].cues == conditions[j].cues &&
          conditions[i].devices == conditions[j].devices && !conditions[i].prescription &&
          !conditions[j].prescription) {
        reading.error_at(element("conditions", i, conditions[i].devices ? "cues" : "devices"),
                         fmt::format("has the same cues as condition {}", in_quotes(conditions[j].name)),
                         "the two would feel alike: change one, or remove it");
        break;
      }
    }
  }
}

void lint_series(ProtocolReading& reading) {
  const auto& series = reading.protocol.series;
  const double reference = reading.protocol.stimulus.reference;
  const std::string_view unit = to_string(reading.protocol.stimulus.unit);
  if (!reading.sound("$.stimulus.reference")) return;
  for (std::size_t i = 0; i < series.size(); ++i) {
    const std::string path = element("series", i, "pair");
    const auto& pair = series[i].pair;
    if (reading.sound(path) && pair[0] != reference && pair[1] != reference) {
      reading.error_at(path,
                       fmt::format("neither {} nor {} {} is the reference, {} {}", plain(pair[0]), plain(pair[1]), unit,
                                   plain(reference), unit),
                       "the Weber fraction's base must be in every pair: change the pair or $.stimulus.reference");
    }
  }
}

void lint_orders(ProtocolReading& reading) {
  const Protocol& protocol = reading.protocol;
  const Design& design = protocol.design;
  const auto look = [&](Order order, std::size_t items, std::string_view key, std::string_view what) {
    const std::string path = fmt::format("$.design.order.{}", key);
    if (!reading.sound(path)) return;
    if (order == Order::permuted && items > kMostPermuted) {
      reading.error_at(path, fmt::format("{} {} have too many orders to permute", items, what),
                       fmt::format("\"permuted\" takes at most {}; use \"williams\" or \"random\"", kMostPermuted));
    }
    if (order == Order::williams && items > kMostWilliams)
      reading.error_at(path, fmt::format("a Williams square of {} {} is too large", items, what), "use \"random\"");
  };
  if (!reading.explores()) look(design.series_order, protocol.series.size(), "series", "series");
  look(design.condition_order, most_conditions(protocol), "conditions", "conditions");

  const bool mixed = design.arrangement == Arrangement::mixed && reading.sound("$.design.conditions");
  if (!mixed) return;
  if (design.condition_order != Order::fixed && reading.sound("$.design.order.conditions"))
    reading.error_at("$.design.order.conditions", "mixed conditions have no blocks to order",
                     "write \"fixed\", or \"conditions\": \"blocked\"");
  if (design.per_series && reading.sound("$.design.per_series"))
    reading.error_at("$.design.per_series", "mixed conditions have no order that could change with the series",
                     "remove it, or write \"conditions\": \"blocked\"");
  for (std::size_t i = 0; i < protocol.questions.size(); ++i) {
    const std::string path = element("questions", i, "when");
    if (protocol.questions[i].when == Question::When::after_condition && reading.sound(path))
      reading.error_at(path, "mixed conditions have no end of a condition to ask after",
                       "ask \"after-session\" with \"per_condition\": true");
  }
}

// With a procedure there is one series, and the trials follow from the tracks.
void lint_adaptive(ProtocolReading& reading) {
  const Design& design = reading.protocol.design;
  const bool one_series = reading.protocol.series.size() < 2;
  if (one_series && reading.sound("$.design.order.series") && design.series_order != Order::fixed)
    reading.error_at("$.design.order.series", "there are no series to order beside a procedure", "write \"fixed\"");
  if (one_series && design.per_series && reading.sound("$.design.per_series"))
    reading.error_at("$.design.per_series", "there are no series that could change the order beside a procedure",
                     "remove it");
  if (!reading.sound(kProcedurePath) || !reading.sound("$.conditions") || !reading.sound("$.groups")) return;
  const int total = design.trials_per_cell * static_cast<int>(most_conditions(reading.protocol)) *
                    static_cast<int>(std::max<std::size_t>(reading.protocol.series.size(), 1));
  if (total > kMostTrialsOfSession)
    reading.error_at(procedure_path("stop"),
                     fmt::format("a session could have {} trials, catch trials among them", total),
                     fmt::format("at most {} are possible", kMostTrialsOfSession));
}

void lint_trials(ProtocolReading& reading) {
  const Protocol& protocol = reading.protocol;
  const Design& design = protocol.design;
  if (reading.procedure() != nullptr) return lint_adaptive(reading);
  const bool counts = reading.sound("$.design.trials_per_cell");
  const bool sampling = reading.sound("$.design.sampling");
  if (design.run_limit && sampling && design.sampling == Sampling::random) {
    reading.error_at("$.design.run_limit", "a run limit changes P(same) of independent random draws",
                     "remove it, or write \"sampling\": \"balanced\"");
  }
  if (!counts || !reading.sound("$.conditions") || !reading.sound("$.groups") || !reading.sound("$.series")) return;
  const auto conditions = static_cast<int>(most_conditions(protocol));
  int cells = 0, largest = 0;
  for (int series = 0; series < static_cast<int>(protocol.series.size()); ++series) {
    const int cell = trials_of_cell(protocol, series);
    cells += cell;
    largest = std::max(largest, cell);
  }
  const int block = design.arrangement == Arrangement::mixed ? largest * conditions : largest;
  if (design.run_limit && block > kMostTrialsOfLimitedBlock) {
    reading.error_at("$.design.run_limit", fmt::format("a block has {} trials", block),
                     fmt::format("a run limit works for blocks of at most {}", kMostTrialsOfLimitedBlock));
  }
  const int total = cells * conditions;
  if (total > kMostTrialsOfSession) {
    reading.error_at("$.design.trials_per_cell", fmt::format("a session would have {} trials", total),
                     fmt::format("at most {} are possible", kMostTrialsOfSession));
  }
}

}  // namespace

void lint_protocol(ProtocolReading& reading) {
  lint_names(reading);
  lint_conditions(reading);
  lint_question_ids(reading);
  lint_orders(reading);
  lint_groups(reading);
  if (reading.explores()) return lint_explore(reading);
  if (reading.has_pairs()) lint_series(reading);
  lint_task(reading);
  lint_trials(reading);
}

}  // namespace jnd
