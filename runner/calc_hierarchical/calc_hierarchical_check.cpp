#include "runner/calc_hierarchical/calc_hierarchical_check.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "data/fields/number_text.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

constexpr std::size_t kColumns = 104;

std::string lines_of(const std::string& text, bool faint) {
  std::string lines;
  for (const std::string& line : wrapped_words(text, kColumns)) lines += (faint ? dim(line) : line) + "\n";
  return lines;
}

bool lies_outside(const PredictiveBand& band) {
  return band.status == BandStatus::below || band.status == BandStatus::above;
}

std::string outside_text(const PredictiveRow& row) {
  std::string text;
  if (lies_outside(row.share)) text = fmt::format("share {}", word_of(kBandStatusWords, row.share.status));
  if (lies_outside(row.between))
    text += fmt::format("{}sd {}", text.empty() ? "" : ", ", word_of(kBandStatusWords, row.between.status));
  return text;
}

nlohmann::ordered_json band_json(const PredictiveBand& band) {
  return {{"observed", json_number(band.observed)},
          {"drawn_low", json_number(band.low)},
          {"drawn_high", json_number(band.high)},
          {"status", word_of(kBandStatusWords, band.status)}};
}

}  // namespace

std::string predictive_text(const PredictiveCheck& check, const std::vector<std::string>& conditions, double origin) {
  using Align = TextTable::Align;
  TextTable table(
      {"condition", "level", "trials", "positive", "95 % of drawn", "sd of people", "95 % of drawn", ""},
      {Align::left, Align::right, Align::right, Align::right, Align::right, Align::right, Align::right, Align::left});
  for (const PredictiveRow& row : check.rows) {
    const bool alone = row.between.status == BandStatus::one_person;
    table.add({printable(conditions[row.condition]), fmt::format("{:g}", origin + row.level),
               fmt::format("{:.0f}", row.trials), percent_text(row.share.observed),
               range_text(percent_text(row.share.low), percent_text(row.share.high)),
               alone ? "-" : number_text(row.between.observed, 3),
               alone ? "-" : range_text(row.between.low, row.between.high, 3), outside_text(row)});
  }
  std::string text = "\n" + bold(fmt::format("posterior predictive check, {} draws", check.draws)) + "\n";
  text += lines_of(predictive_verdict(check), false) + table.text();
  return text + lines_of(fmt::format("Drawn: answers of the same people to the same questions, by the model; positive: "
                                     "share of positive answers; sd of people: of their shares. Discrepancy of the "
                                     "answers {:.1f}, of drawn ones {:.1f}. {}",
                                     check.observed, check.drawn, kPredictiveMeaning),
                         true);
}

nlohmann::ordered_json predictive_json(const PredictiveCheck& check, const std::vector<std::string>& conditions,
                                       double origin) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const PredictiveRow& row : check.rows)
    rows.push_back({{"condition", conditions[row.condition]},
                    {"level", origin + row.level},
                    {"participants", row.participants},
                    {"trials", std::llround(row.trials)},
                    {"share", band_json(row.share)},
                    {"sd_between", band_json(row.between)}});
  nlohmann::ordered_json out = predictive_summary_json(check);
  out["rows"] = std::move(rows);
  return out;
}

nlohmann::ordered_json predictive_summary_json(const PredictiveCheck& check) {
  return {{"draws", check.draws},
          {"fits", check.bands_fit() && check.scatter_fits()},
          {"verdict", predictive_verdict(check)},
          {"bands", check.bands()},
          {"outside", check.outside()},
          {"outside_by_chance", check.outside_by_chance()},
          {"discrepancy", json_number(check.observed)},
          {"discrepancy_drawn", json_number(check.drawn)},
          {"p", json_number(check.p)}};
}

}  // namespace jnd
