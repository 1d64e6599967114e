// jnd calc magnitude, jnd calc adjust: numbers given to stimuli, and settings made to match a standard.
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "analysis/scaling/adjustment.h"
#include "analysis/scaling/magnitude.h"
#include "data/fields/number_text.h"
#include "protocols/input/csv_table.h"
#include "runner/calc/calc.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;
using Align = TextTable::Align;

constexpr NumberRange kScaled{-1e100, 1e100};  // squares stay far from the limits of double

Json bounds_json(double low, double high) {
  return Json::array({json_number(low), json_number(high)});
}

Json mean_json(const MeanInterval& of) {
  return {{"n", of.n},
          {"mean", json_number(of.mean)},
          {"sd", json_number(of.sd)},
          {"se", json_number(of.se)},
          {"ci", bounds_json(of.ci_low, of.ci_high)},
          {"status", to_text(of.status)}};
}

std::string scaled(double value) {
  return number_text(value, decimals_of_size(std::abs(value)));
}

std::string bounds_text(double low, double high) {
  return range_text(scaled(low), scaled(high));
}

// The participant of a row; one without a name where the file has no such column.
std::string participant_of(const CsvTable& csv, std::size_t row) {
  if (!csv.has("participant")) return {};
  std::string name(csv.text(row, "participant"));
  if (name.empty()) csv.fail(row, "participant", "is empty", "every row names its participant");
  return name;
}

std::string shown(const std::string& participant) {
  return participant.empty() ? "(one participant)" : printable(participant);
}

// ---- magnitude

struct MagnitudeOptions {
  CalcInput input;
};

// The answers of a file, with the row that each stands in: rows has the shape of estimates.answers.
struct MagnitudeTable {
  std::vector<std::string> participants;
  MagnitudeEstimates estimates;
  std::vector<std::vector<std::vector<std::size_t>>> rows;
};

void refuse_empty_cells(const CsvTable& csv, const MagnitudeTable& table) {
  for (std::size_t p = 0; p < table.participants.size(); ++p)
    for (std::size_t i = 0; i < table.estimates.stimuli.size(); ++i)
      if (table.rows[p][i].empty()) {
        std::size_t first = 0;
        while (participant_of(csv, first) != table.participants[p]) ++first;
        csv.fail(first, csv.has("participant") ? "participant" : "stimulus",
                 fmt::format("{} has no answer to {:g}", shown(table.participants[p]), table.estimates.stimuli[i]),
                 "every participant answers every stimulus: add the missing rows, or leave out the participant or the "
                 "stimulus and say so in the report");
      }
}

// Participants and stimuli in the order of their first row.
MagnitudeTable magnitude_table(const CsvTable& csv) {
  MagnitudeTable table;
  std::map<std::string, std::size_t> participants;
  std::map<double, std::size_t> stimuli;
  std::vector<std::array<std::size_t, 2>> cells;
  for (std::size_t row = 0; row < csv.rows(); ++row) {
    const std::string name = participant_of(csv, row);
    const double stimulus = csv.number(row, "stimulus", kScaled);
    if (!(stimulus > 0))
      csv.fail(row, "stimulus", fmt::format("{:g} is not above 0", stimulus),
               "the power law holds for stimuli above 0: give the stimulus in its unit, not as a difference");
    const auto [p, new_name] = participants.try_emplace(name, participants.size());
    if (new_name) table.participants.push_back(name);
    const auto [i, new_stimulus] = stimuli.try_emplace(stimulus, stimuli.size());
    if (new_stimulus) table.estimates.stimuli.push_back(stimulus);
    cells.push_back({p->second, i->second});
  }
  table.estimates.answers.assign(participants.size(), std::vector<std::vector<double>>(stimuli.size()));
  table.rows.assign(participants.size(), std::vector<std::vector<std::size_t>>(stimuli.size()));
  for (std::size_t row = 0; row < csv.rows(); ++row) {
    const auto [p, i] = cells[row];
    table.estimates.answers[p][i].push_back(csv.number(row, "answer", kScaled));
    table.rows[p][i].push_back(row);
  }
  refuse_empty_cells(csv, table);
  return table;
}

[[noreturn]] void refuse_answers(const CsvTable& csv, const MagnitudeTable& table,
                                 const std::vector<RefusedAnswer>& refused) {
  constexpr std::size_t kNamed = 5;
  std::string where;
  for (std::size_t n = 0; n < refused.size() && n < kNamed; ++n) {
    const RefusedAnswer& one = refused[n];
    where += fmt::format("{}{}, stimulus {:g}, answer {}: {:g}", n > 0 ? "; " : "",
                         shown(table.participants[one.participant - 1]), table.estimates.stimuli[one.stimulus - 1],
                         one.repeat, one.answer);
  }
  if (refused.size() > kNamed) where += fmt::format("; and {} more", refused.size() - kNamed);
  const RefusedAnswer& first = refused.front();
  csv.fail(table.rows[first.participant - 1][first.stimulus - 1][first.repeat - 1], "answer",
           fmt::format("{} not above 0: {}",
                       refused.size() == 1 ? "1 answer is"
                                           : counted(static_cast<std::int64_t>(refused.size()), "answer") + " are",
                       where),
           "a magnitude is a ratio to others, and 0 is none: look the answers up, or leave the participant out and say "
           "so in the report");
}

Json law_json(const PowerLaw& law) {
  return {{"exponent", json_number(law.exponent)},
          {"intercept", json_number(law.intercept)},
          {"se", json_number(law.se)},
          {"ci", bounds_json(law.ci_low, law.ci_high)},
          {"r2", json_number(law.r2)},
          {"residual_sd", json_number(law.residual_sd)},
          {"status", to_text(law.status)},
          {"interval_status", to_text(law.interval_status)},
          {"r2_status", to_text(law.r2_status)}};
}

Json magnitude_json(const MagnitudeTable& table, const MagnitudeScale& scale) {
  Json out = {{"status", "ok"}, {"stimuli", json_numbers(table.estimates.stimuli)}};
  for (std::size_t p = 0; p < scale.participants.size(); ++p) {
    const ParticipantMagnitudes& one = scale.participants[p];
    out["cell_geometric_means"].push_back(json_numbers(one.cells));
    out["participant_geometric_mean"].push_back(json_number(one.geometric_mean));
    out["normalised"].push_back(json_numbers(one.normalised));
    Json law = law_json(one.law);
    law["participant"] = table.participants[p].empty() ? Json(nullptr) : Json(table.participants[p]);
    out["participants"].push_back(std::move(law));
  }
  out["grand_geometric_mean"] = json_number(scale.grand_geometric_mean);
  out["group_geometric_means"] = json_numbers(scale.group_geometric_means);
  out["group_ln_se"] = scale.group_ln_se.empty() ? Json(nullptr) : json_numbers(scale.group_ln_se);
  out["group"] = law_json(scale.group);
  out["exponents"] = mean_json(scale.exponents);
  return out;
}

Json refused_json(const std::vector<RefusedAnswer>& refused) {
  Json places = Json::array();
  for (const RefusedAnswer& one : refused)
    places.push_back(Json::array({one.participant, one.stimulus, one.repeat, json_number(one.answer)}));
  return {{"status", "refused"}, {"not_positive", std::move(places)}};
}

void add_law(TextTable& table, const std::string& name, double mean, const PowerLaw& law) {
  table.add({name, scaled(mean), scaled(law.exponent), bounds_text(law.ci_low, law.ci_high), scaled(law.se),
             scaled(law.r2), scaled(law.residual_sd)});
}

std::string magnitude_text(const MagnitudeTable& table, const MagnitudeScale& scale) {
  TextTable laws({"participant", "geometric mean", "exponent", "95 % CI", "SE", "r2", "residual SD"},
                 {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right});
  for (std::size_t p = 0; p < scale.participants.size(); ++p)
    add_law(laws, shown(table.participants[p]), scale.participants[p].geometric_mean, scale.participants[p].law);
  laws.rule();
  add_law(laws, "group", scale.grand_geometric_mean, scale.group);
  TextTable stimuli({"stimulus", "geometric mean", "SE of its logarithm"}, {Align::right, Align::right, Align::right});
  for (std::size_t i = 0; i < table.estimates.stimuli.size(); ++i)
    stimuli.add({fmt::format("{:g}", table.estimates.stimuli[i]), scaled(scale.group_geometric_means[i]),
                 scale.group_ln_se.empty() ? "-" : scaled(scale.group_ln_se[i])});
  std::string text = laws.text() + "Group, with equal moduli\n" + stimuli.text();
  text += fmt::format("mean exponent {}, SD {}, 95 % CI {}, {}\n", scaled(scale.exponents.mean),
                      scaled(scale.exponents.sd), bounds_text(scale.exponents.ci_low, scale.exponents.ci_high),
                      counted(scale.exponents.n, "participant"));
  if (scale.group.interval_status != StatisticStatus::ok)
    text += "Fewer than three stimuli: a line through them has no error, so no interval.\n";
  return text;
}

int magnitude(const MagnitudeOptions& options) {
  const CsvTable csv = CsvTable::read(options.input.file, {"stimulus", "answer"}, {"participant"});
  say_look_alikes(csv, "participant", options.input.file);
  const MagnitudeTable table = magnitude_table(csv);
  const MagnitudeScale scale = magnitude_scale(table.estimates);
  if (!scale.ok()) {
    if (options.input.json) print_json(refused_json(scale.refused));
    refuse_answers(csv, table, scale.refused);
  }
  if (options.input.json)
    print_json(magnitude_json(table, scale));
  else
    fmt::print("{}", magnitude_text(table, scale));
  return exit_code::kDone;
}

// ---- adjust

struct AdjustOptions {
  CalcInput input;
  double standard = 0;
};

StartSide start_of(const CsvTable& csv, std::size_t row) {
  if (!csv.has("start")) return StartSide::unknown;
  const int side = csv.integer(row, "start", -1, 1);
  if (side == 0) csv.fail(row, "start", "0 is no side", "1: started from above the standard; -1: from below");
  return side > 0 ? StartSide::above : StartSide::below;
}

struct AdjustmentTable {
  std::vector<std::string> names;  // in the order of their first row
  std::vector<Adjustment> participants;
};

AdjustmentTable adjustment_table(const CsvTable& csv, double standard) {
  AdjustmentTable table;
  std::map<std::string, std::vector<Setting>> settings;
  for (std::size_t row = 0; row < csv.rows(); ++row) {
    const auto [place, added] = settings.try_emplace(participant_of(csv, row));
    if (added) table.names.push_back(place->first);
    place->second.push_back({csv.number(row, "setting", kScaled), start_of(csv, row)});
  }
  for (const std::string& name : table.names) table.participants.push_back(adjustment(settings[name], standard));
  return table;
}

Json adjustment_json(const std::string& name, const Adjustment& of) {
  Json out = {{"participant", name.empty() ? Json(nullptr) : Json(name)},
              {"n", of.settings.n},
              {"pse", json_number(of.settings.mean)},
              {"constant_error", json_number(of.constant_error)},
              {"sd", json_number(of.settings.sd)},
              {"jnd", json_number(of.jnd)},
              {"jnd_ci", bounds_json(of.jnd_low, of.jnd_high)},
              {"weber", json_number(of.weber)},
              {"se", json_number(of.settings.se)},
              {"pse_ci", bounds_json(of.settings.ci_low, of.settings.ci_high)},
              {"status", to_text(of.settings.status)},
              {"start_status", to_text(of.start_status)}};
  if (of.start_status != StatisticStatus::ok) return out;
  out["mean_from_above"] = json_number(of.mean_from_above);
  out["mean_from_below"] = json_number(of.mean_from_below);
  out["start_effect"] = json_number(of.start_effect);
  out["variable_error"] = json_number(of.variable_error);
  out["jnd_within_side"] = json_number(of.jnd_within_side);
  out["start_test_status"] = to_text(of.start_test_status);
  if (of.start_test_status != StatisticStatus::ok) return out;
  out["start_t"] = json_number(of.start_t);
  out["start_df"] = of.start_df;
  out["start_p"] = json_number(of.start_p);
  return out;
}

Json adjustment_group_json(const AdjustmentGroup& group) {
  Json out;
  out["pse"] = mean_json(group.pse);
  out["constant_error"] = mean_json(group.constant_error);
  out["constant_error_t"] = json_number(group.constant_error_test.t);
  out["constant_error_p"] = json_number(group.constant_error_test.p);
  out["constant_error_status"] = to_text(group.constant_error_test.status);
  out["jnd"] = mean_json(group.jnd);
  out["ln_jnd"] = mean_json(group.ln_jnd);
  out["jnd_geometric_mean"] = json_number(group.jnd_geometric_mean);
  out["jnd_geometric_ci"] = bounds_json(group.jnd_geometric_ci_low, group.jnd_geometric_ci_high);
  out["ln_jnd_status"] = to_text(group.ln_jnd_status);
  out["start_status"] = to_text(group.start_status);
  if (group.start_status != StatisticStatus::ok) return out;
  out["start_effect"] = mean_json(group.start_effect);
  out["start_effect_t"] = json_number(group.start_effect_test.t);
  out["start_effect_p"] = json_number(group.start_effect_test.p);
  out["start_effect_status"] = to_text(group.start_effect_test.status);
  return out;
}

std::string adjustment_text(const AdjustmentTable& of_all) {
  TextTable table({"participant", "n", "PSE", "95 % CI", "constant error", "SD", "JND", "Weber", "start effect", "p",
                   "variable error"},
                  {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right,
                   Align::right, Align::right, Align::right, Align::right});
  for (std::size_t p = 0; p < of_all.names.size(); ++p) {
    const Adjustment& of = of_all.participants[p];
    table.add({shown(of_all.names[p]), std::to_string(of.settings.n), scaled(of.settings.mean),
               bounds_text(of.settings.ci_low, of.settings.ci_high), scaled(of.constant_error), scaled(of.settings.sd),
               scaled(of.jnd), percent_text(of.weber), scaled(of.start_effect), p_value_text(of.start_p),
               scaled(of.variable_error)});
  }
  return table.text();
}

std::string adjustment_group_text(const AdjustmentGroup& group) {
  TextTable table({"group", "n", "mean", "SD", "95 % CI", "t", "p"},
                  {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right});
  const auto add = [&](const char* name, const MeanInterval& of, const std::string& t, const std::string& p) {
    table.add({name, std::to_string(of.n), scaled(of.mean), scaled(of.sd), bounds_text(of.ci_low, of.ci_high), t, p});
  };
  add("PSE", group.pse, "", "");
  add("constant error", group.constant_error, scaled(group.constant_error_test.t),
      p_value_text(group.constant_error_test.p));
  add("JND", group.jnd, "", "");
  add("start effect", group.start_effect, scaled(group.start_effect_test.t), p_value_text(group.start_effect_test.p));
  return table.text() + fmt::format("geometric mean of the JND {}, 95 % CI {}\n", scaled(group.jnd_geometric_mean),
                                    bounds_text(group.jnd_geometric_ci_low, group.jnd_geometric_ci_high));
}

int adjust_settings(const AdjustOptions& options) {
  const CsvTable csv = CsvTable::read(options.input.file, {"setting"}, {"participant", "start"});
  say_look_alikes(csv, "participant", options.input.file);
  const AdjustmentTable table = adjustment_table(csv, options.standard);
  const AdjustmentGroup group = adjustment_group(table.participants);
  if (options.input.json) {
    Json out = {{"standard", options.standard}};
    for (std::size_t p = 0; p < table.names.size(); ++p)
      out["participants"].push_back(adjustment_json(table.names[p], table.participants[p]));
    out["group"] = adjustment_group_json(group);
    print_json(out);
    return exit_code::kDone;
  }
  fmt::print("JND = 0.6745 SD of the settings; start effect: mean from above minus mean from below\n{}",
             adjustment_text(table));
  if (table.names.size() > 1) fmt::print("{}", adjustment_group_text(group));
  return exit_code::kDone;
}

}  // namespace

void add_calc_scaling(CommandTree& calc) {
  const auto [magnitudes, magnitude_options] =
      calc.add("magnitude", "Magnitude estimation: exponents of the power law, with equal moduli",
               "jnd calc magnitude answers.csv --json", magnitude);
  add_input(magnitudes, magnitude_options.input,
            "participant, stimulus, answer: a row an answer, repeats are rows; without participant there is one");

  const auto [adjust, adjust_options] =
      calc.add("adjust", "Settings of the method of adjustment: PSE, JND, effect of the starting side",
               "jnd calc adjust settings.csv --standard 500 --json", adjust_settings);
  add_input(adjust, adjust_options.input,
            "participant, setting, start (1: from above the standard, -1: from below); without participant there is "
            "one, without start no effect of it");
  adjust
      .add_option("--standard", adjust_options.standard, "what was to be matched, above 0, in the unit of the settings")
      .required()
      .check(not_above_0);
}

}  // namespace jnd
