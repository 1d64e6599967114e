#include "runner/power/power_tally.h"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace jnd {

namespace {

constexpr int kBinsInOctave = 128, kInfinite = 1 << 20;

// truth: NaN where it is not known; then nothing is counted as covered, and intervals only for their widths.
void add_estimate(EstimateTally& tally, double estimate, double low, double high, double truth) {
  if (std::isnan(estimate)) return;
  ++tally.defined;
  if (std::isfinite(estimate)) {
    const double error = estimate - (std::isnan(truth) ? 0 : truth), square = error * error;
    tally.errors.add(error);
    tally.squares.add(square);
    tally.fourths.add(square * square);
  }
  if (std::isnan(low) || std::isnan(high)) return;
  ++tally.intervals;
  if (low <= truth && truth <= high) ++tally.covered;
  if (high > low) tally.half_widths.add(0.5 * (high - low));
}

nlohmann::ordered_json to_json(const EstimateTally& tally) {
  nlohmann::ordered_json bins = nlohmann::ordered_json::array();
  for (const auto& [bin, count] : tally.half_widths.bins()) bins.push_back({bin, count});
  return {{"defined", tally.defined},
          {"errors", tally.errors.text()},
          {"squares", tally.squares.text()},
          {"fourths", tally.fourths.text()},
          {"intervals", tally.intervals},
          {"covered", tally.covered},
          {"half_widths", bins}};
}

EstimateTally estimate_tally_from(const nlohmann::ordered_json& json) {
  EstimateTally tally;
  json.at("defined").get_to(tally.defined);
  tally.errors = ExactSum::from_text(json.at("errors").get<std::string>());
  tally.squares = ExactSum::from_text(json.at("squares").get<std::string>());
  tally.fourths = ExactSum::from_text(json.at("fourths").get<std::string>());
  json.at("intervals").get_to(tally.intervals);
  json.at("covered").get_to(tally.covered);
  std::map<int, std::int64_t> bins;
  for (const auto& bin : json.at("half_widths")) bins[bin.at(0).get<int>()] += bin.at(1).get<std::int64_t>();
  tally.half_widths = LogHistogram::of(std::move(bins));
  return tally;
}

template <typename Tally>
void add_each(std::vector<Tally>& to, const std::vector<Tally>& from) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += from[i];
}

}  // namespace

void LogHistogram::add(double value) {
  ++bins_[std::isinf(value) ? kInfinite : static_cast<int>(std::floor(std::log2(value) * kBinsInOctave))];
}

LogHistogram& LogHistogram::operator+=(const LogHistogram& other) {
  for (const auto& [bin, count] : other.bins_) bins_[bin] += count;
  return *this;
}

LogHistogram LogHistogram::of(std::map<int, std::int64_t> bins) {
  LogHistogram histogram;
  histogram.bins_ = std::move(bins);
  return histogram;
}

double LogHistogram::quantile(double share) const {
  std::int64_t all = 0, below = 0;
  for (const auto& [bin, count] : bins_) all += count;
  for (const auto& [bin, count] : bins_) {
    below += count;
    if (static_cast<double>(below) >= share * static_cast<double>(all))
      return bin == kInfinite ? kInf : std::exp2((bin + 0.5) / kBinsInOctave);
  }
  return kNaN;
}

EstimateTally& EstimateTally::operator+=(const EstimateTally& other) {
  defined += other.defined;
  errors += other.errors;
  squares += other.squares;
  fourths += other.fourths;
  intervals += other.intervals;
  covered += other.covered;
  half_widths += other.half_widths;
  return *this;
}

ContrastTally& ContrastTally::operator+=(const ContrastTally& other) {
  estimates += other.estimates;
  tested += other.tested;
  significant += other.significant;
  return *this;
}

AnalysisTally& AnalysisTally::operator+=(const AnalysisTally& other) {
  add_each(group, other.group);
  add_each(contrasts, other.contrasts);
  undefined += other.undefined;
  any += other.any;
  all += other.all;
  return *this;
}

void AnalysisTally::add(const StudyOutcome& outcome, PowerAnalysis analysis, const StudyAnalyst& analyst,
                        double alpha) {
  for (std::size_t c = 0; c < group.size(); ++c) {
    const GroupJnd& one = outcome.group[c];
    add_estimate(group[c], std::log(one.jnd),
                 one.low > 0    ? std::log(one.low)
                 : one.low <= 0 ? -kInf
                                : kNaN,
                 std::log(one.high), std::log(analyst.true_jnd(analysis, c)));
  }
  bool some = false, every = !contrasts.empty();
  for (std::size_t i = 0; i < contrasts.size(); ++i) {
    if (!analyst.has_test(analysis, i)) continue;
    const GroupContrast& one = outcome.contrasts[i];
    add_estimate(contrasts[i].estimates, one.difference, one.low, one.high, analyst.true_difference(analysis, i));
    const bool significant = one.p < alpha;
    if (!std::isnan(one.p)) ++contrasts[i].tested;
    if (significant) ++contrasts[i].significant;
    some = some || significant;
    every = every && significant;
  }
  if (outcome.undefined) ++undefined;
  if (some) ++any;
  if (every) ++all;
}

PowerTally& PowerTally::operator+=(const PowerTally& other) {
  studies += other.studies;
  for (std::size_t i = 0; i < by_design.size(); ++i) add_each(by_design[i], other.by_design[i]);
  return *this;
}

PowerTally PowerTally::of(const PowerQuestion& question) {
  AnalysisTally one;
  one.group.resize(question.jnds.size());
  one.contrasts.resize(question.tests());
  PowerTally tally;
  tally.by_design.assign(question.designs().size(), std::vector<AnalysisTally>(question.analyses.size(), one));
  return tally;
}

nlohmann::ordered_json to_json(const PowerTally& tally) {
  nlohmann::ordered_json designs = nlohmann::ordered_json::array();
  for (const std::vector<AnalysisTally>& analyses : tally.by_design) {
    nlohmann::ordered_json row = nlohmann::ordered_json::array();
    for (const AnalysisTally& one : analyses) {
      nlohmann::ordered_json group = nlohmann::ordered_json::array(), contrasts = group;
      for (const EstimateTally& of_condition : one.group) group.push_back(to_json(of_condition));
      for (const ContrastTally& contrast : one.contrasts)
        contrasts.push_back({{"estimates", to_json(contrast.estimates)},
                             {"tested", contrast.tested},
                             {"significant", contrast.significant}});
      row.push_back({{"group", group},
                     {"contrasts", contrasts},
                     {"undefined", one.undefined},
                     {"any", one.any},
                     {"all", one.all}});
    }
    designs.push_back(std::move(row));
  }
  return {{"studies", tally.studies}, {"designs", designs}};
}

PowerTally power_tally_from(const nlohmann::ordered_json& json, const PowerQuestion& question) {
  PowerTally tally = PowerTally::of(question);
  const auto same_size = [](const nlohmann::ordered_json& list, std::size_t size) {
    if (!list.is_array() || list.size() != size) throw std::invalid_argument("a tally of another question");
  };
  json.at("studies").get_to(tally.studies);
  const nlohmann::ordered_json& designs = json.at("designs");
  same_size(designs, tally.by_design.size());
  for (std::size_t d = 0; d < designs.size(); ++d) {
    same_size(designs[d], tally.by_design[d].size());
    for (std::size_t a = 0; a < designs[d].size(); ++a) {
      const nlohmann::ordered_json& from = designs[d][a];
      AnalysisTally& to = tally.by_design[d][a];
      same_size(from.at("group"), to.group.size());
      same_size(from.at("contrasts"), to.contrasts.size());
      for (std::size_t c = 0; c < to.group.size(); ++c) to.group[c] = estimate_tally_from(from.at("group")[c]);
      for (std::size_t i = 0; i < to.contrasts.size(); ++i) {
        const nlohmann::ordered_json& contrast = from.at("contrasts")[i];
        to.contrasts[i].estimates = estimate_tally_from(contrast.at("estimates"));
        contrast.at("tested").get_to(to.contrasts[i].tested);
        contrast.at("significant").get_to(to.contrasts[i].significant);
      }
      from.at("undefined").get_to(to.undefined);
      from.at("any").get_to(to.any);
      from.at("all").get_to(to.all);
    }
  }
  return tally;
}

}  // namespace jnd
