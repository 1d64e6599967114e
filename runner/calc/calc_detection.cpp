// jnd calc sdt: d' of counts, model by model. jnd calc coverage: how often its intervals and tests are right.
#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "analysis/detection/coverage.h"
#include "analysis/detection/detection_row.h"
#include "data/blocks/common_fields.h"
#include "data/blocks/detection_fields.h"
#include "data/blocks/part_fields.h"
#include "protocols/input/csv_table.h"
#include "runner/calc/calc.h"
#include "runner/calc/calc_output.h"
#include "runner/calc/trials_input.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/progress_bar.h"

namespace jnd {

namespace {

struct SdtOptions {
  CalcInput input;
  TrialOptions trials;
};

struct SdtRow {
  std::string id;
  Counts counts;
  std::optional<std::string> participant = std::nullopt, condition = std::nullopt;  // of trials
  std::optional<double> difference = std::nullopt;                                  // of trials
  const DetectionRow* found = nullptr;
};

std::vector<SdtRow> counted_rows(const SdtOptions& options) {
  refuse_trial_options(options.trials, kSameDifferentUse);
  const CsvTable table = CsvTable::read(options.input.file, {"id", "n_diff", "hits", "n_same", "false_alarms"});
  std::vector<SdtRow> rows;
  for (std::size_t row = 0; row < table.rows(); ++row)
    rows.push_back({std::string(table.text(row, "id")), counts_of(table, row)});
  return rows;
}

// A row for each difference; the same trials of a unit go with all of its differences.
std::vector<SdtRow> rows_of_trials(const SdtOptions& options) {
  const TrialTable table = read_trials(options.input.file, options.trials, kSameDifferentUse);
  const std::vector<std::vector<TrialCount>> counts = count_trials(table);
  std::vector<SdtRow> rows;
  for (std::size_t unit = 0; unit < counts.size(); ++unit) {
    const TrialUnit& of = table.units[unit];
    Counts same;
    for (const TrialCount& count : counts[unit])
      if (count.level == 0) same = {0, 0, count.n, count.k};
    for (const TrialCount& count : counts[unit]) {
      if (count.level == 0 && counts[unit].size() > 1) continue;
      Counts cell = same;
      if (count.level != 0) cell += {count.n, count.k, 0, 0};
      rows.push_back(
          {fmt::format("{} / {:g}", of.name(), count.level), cell, of.participant, of.condition, count.level});
    }
  }
  return rows;
}

Fields<SdtRow> sdt_fields(const SdtRow& first) {
  using R = SdtRow;
  using F = Field<R>;
  Fields<R> fields = {F("id", "name of the row", &R::id)};
  if (first.participant) fields.push_back(common<R>("participant", &R::participant));
  if (first.condition) fields.push_back(common<R>("condition", &R::condition));
  if (first.difference) fields.push_back(F("delta", "difference of the stimuli", &R::difference));
  add_detection_fields(fields, [](const R& r) -> const DetectionRow& { return *r.found; });
  return fields;
}

std::vector<Block> sdt_blocks(const std::vector<SdtRow>& rows) {
  Block yes_no, others;
  yes_no.title = "yes-no model, log-linear correction";
  yes_no.note =
      "Profile-likelihood interval and two-sided test of d' = 0 on the raw counts; se: Gourevitch and Galanter.";
  yes_no.columns = columns(
      "id", share("hits", "n_diff", "hits", "/"), share("false_alarms", "n_same", "false alarms", "/"),
      titled("yes_no.loglinear.dprime", "d'"), range("yes_no.profile.ci_low", "yes_no.profile.ci_high", "95 % profile"),
      titled("yes_no.profile.p_value", "p"), titled("yes_no.loglinear.criterion", "c"),
      titled("yes_no.loglinear.ln_beta", "ln beta"), titled("yes_no.loglinear.se", "se"), "status");
  const auto say = [&](RateStatus status, const char* meaning) {
    const auto n = std::count_if(rows.begin(), rows.end(), [&](const SdtRow& r) { return r.found->status == status; });
    if (n > 0) yes_no.footnotes.push_back(fmt::format("{} of {} rows {}.", n, rows.size(), meaning));
  };
  say(RateStatus::missing, "lack a class: no d'");
  say(RateStatus::no_information,
      "hold one and the same answer throughout: their d' is the arithmetic of the correction, not an observation");
  others.title = "d' of the same counts under other corrections and models";
  others.note =
      "Differencing: maximum likelihood on raw counts, then of log-linear rates. Independent observation, log-linear "
      "rates: unit slope, and the exact likelihood-ratio observer. d' of different models are different quantities.";
  others.columns = columns(
      "id", range("bootstrap.q025", "bootstrap.q975", "bootstrap 95 %"), titled("yes_no.none.dprime", "yes-no raw"),
      titled("yes_no.half.dprime", "half"), titled("differencing.dprime", "differencing raw"),
      range("differencing.ci_low", "differencing.ci_high", "95 % profile"),
      titled("differencing.p_value", "p one-sided"), titled("differencing_loglinear.dprime", "log-linear"),
      titled("independent.loglinear.unit_slope", "independent"), titled("independent.loglinear.exact", "exact"));
  const Fields<SdtRow> fields = sdt_fields(rows.front());
  return {yes_no.with(fields, rows), others.with(fields, rows)};
}

int sdt(const SdtOptions& options) {
  std::vector<SdtRow> rows = options.trials.trials ? rows_of_trials(options) : counted_rows(options);
  // A new row costs a millisecond, but in large files most counts occur more than once.
  std::map<std::array<int, 4>, DetectionRow> known;
  {
    ProgressBar progress("rows", static_cast<std::int64_t>(rows.size()));
    for (std::size_t row = 0; row < rows.size(); ++row) {
      constexpr std::size_t kRowsOfASecond = 1000;
      if (row > 0 && row % kRowsOfASecond == 0) progress.update(static_cast<std::int64_t>(row));
      const Counts& counts = rows[row].counts;
      const auto [place, added] =
          known.try_emplace({counts.n_diff, counts.hits, counts.n_same, counts.false_alarms}, DetectionRow{});
      if (added) place->second = detection_row(counts);
      rows[row].found = &place->second;
    }
  }
  print_rows(sdt_blocks(rows), options.input.json);
  return exit_code::kDone;
}

struct CoverageOptions {
  std::vector<int> trials = {6, 12, 24, 48, 100, 200};
  bool json = false;
};

constexpr std::array kDprimes = {0.0, 0.5, 1.0, 1.5, 2.0};

struct CoverageRow {
  int trials;
  double criterion;
  TestSizes sizes;
  std::array<double, kDprimes.size()> coverage;
};

std::vector<Block> coverage_blocks(const std::vector<CoverageRow>& rows) {
  using R = CoverageRow;
  using T = TestSizes;
  Fields<R> fields = {{"trials_a_class", "trials of each class", &R::trials, {.title = "trials per class"}},
                      {"criterion", "criterion c", &R::criterion, {.title = "c", .shown = Shown::given}}};
  add_parts(fields, "test_sizes.", "share of experiments with such a p where d' is 0", {.factor = 100}, &R::sizes,
            "yes_no_05", &T::yes_no_05, "yes_no_01", &T::yes_no_01, "differencing_05", &T::differencing_05,
            "differencing_01", &T::differencing_01);
  Block profile, sizes;
  profile.title = "Coverage of the 95 % profile-likelihood interval of the yes-no d', in percent";
  profile.columns = columns("trials_a_class", "criterion");
  for (std::size_t i = 0; i < kDprimes.size(); ++i) {
    profile.columns.push_back({fmt::format("d' = {:g}", kDprimes[i])});
    fields.emplace_back(
        profile.columns.back().key, "coverage at that d'", [i](const R& r) { return r.coverage[i]; },
        FieldTraits{.factor = 100, .place = Place::table});
  }
  sizes.title = "Size of the tests of d' = 0, in percent of experiments that have p <= 5 % and p <= 1 %";
  sizes.columns =
      columns("trials_a_class", "criterion", titled("test_sizes.yes_no_05", "yes-no 5 %"),
              titled("test_sizes.yes_no_01", "yes-no 1 %"), titled("test_sizes.differencing_05", "differencing 5 %"),
              titled("test_sizes.differencing_01", "differencing 1 %"));
  return {profile.with(fields, rows), sizes.with(fields, rows)};
}

int coverage(const CoverageOptions& options) {
  std::vector<CoverageRow> rows;
  for (const int trials : options.trials) {
    const ProfileCoverage coverage(trials);
    for (const double criterion : {-0.5, 0.0, 0.5}) {
      rows.push_back({trials, criterion, test_sizes(trials, criterion), {}});
      for (std::size_t i = 0; i < kDprimes.size(); ++i) rows.back().coverage[i] = coverage.at(kDprimes[i], criterion);
    }
  }
  print_rows(coverage_blocks(rows), options.json, [&](nlohmann::ordered_json& line, std::size_t row) {
    for (std::size_t i = 0; i < kDprimes.size(); ++i)
      line["coverage"].push_back({{"dprime", kDprimes[i]}, {"profile", rows[row].coverage[i]}});
  });
  return exit_code::kDone;
}

}  // namespace

void add_calc_detection(CommandTree& calc) {
  const auto [detection, counts] = calc.add("sdt", "d' of same-different counts, under every model and correction",
                                            "jnd calc sdt counts.csv --json", sdt);
  add_input(detection, counts.input, "id, n_diff, hits, n_same, false_alarms");
  add_trial_options(detection, counts.trials, kSameDifferentUse);

  const auto [command, options] =
      calc.add("coverage", "How often the intervals and tests of sdt are right, by exact enumeration",
               "jnd calc coverage --trials 12,48", coverage);
  command.add_option("--trials", options.trials, "trials per class, each 1 to 500")
      .delimiter(',')
      .range(1, 500)
      .show_default();
  command.add_flag("--json", options.json, "machine-readable, a line per number of trials and criterion");
}

}  // namespace jnd
