#include "analysis/hierarchical/predictive_check.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "analysis/numerics/binomial.h"
#include "analysis/numerics/experiment_stream.h"
#include "analysis/numerics/sample_quantile.h"
#include "analysis/numerics/stop_request.h"

namespace jnd {

namespace {

constexpr std::uint64_t kDrawPurpose = 0x706f7374'64726177;
constexpr double kPlasticU = 0.7548776662466927, kPlasticW = 0.5698402909980532;

double fraction(double value) {
  return value - std::floor(value);
}

// v of one person in one condition, given u and w.
class WithinPerson {
 public:
  WithinPerson(ResponseModel model, const SharedParameters& shared) : model_(model), shared_(shared) {}

  // answers: of the person in the condition; tv: there; ln_s: without v; offset, number: uniform in (0, 1).
  double drawn(std::span<const HierarchicalCell> answers, double tv, double ln_s, double criterion, double offset,
               double number) {
    constexpr double kReach = 6, kNodesOfSd = 1.5;  // likelihoods are less smooth than normal densities
    if (tv == 0) return 0;
    design_.clear();
    for (const HierarchicalCell& cell : answers) design_.push_back({cell.level, cell.positive + cell.negative});
    const double information = expected_information(model_, design_, ln_s, criterion, shared_).s;
    const double spacing = 1 / std::sqrt(1 / (tv * tv) + information) / kNodesOfSd;
    const int last = static_cast<int>(std::ceil(kReach * tv / spacing));
    logs_.clear();
    for (int node = -last; node < last; ++node) {
      const double v = (node + offset) * spacing;
      double log_value = -v * v / (2 * tv * tv);
      for (const HierarchicalCell& cell : answers)
        log_value += log_likelihood_of(cell.counts(), model_, cell.level, ln_s + v, criterion, shared_);
      logs_.push_back(log_value);
    }
    const double largest = *std::max_element(logs_.begin(), logs_.end());
    double sum = 0;
    for (double& one : logs_) one = sum += std::exp(one - largest);
    const auto chosen = std::min(std::upper_bound(logs_.begin(), logs_.end(), number * sum), logs_.end() - 1);
    return (static_cast<double>(chosen - logs_.begin()) - last + offset) * spacing;
  }

 private:
  ResponseModel model_;
  SharedParameters shared_;
  std::vector<LevelTrials> design_;
  std::vector<double> logs_;
};

constexpr std::uint64_t kAnswerPurpose = 0x70726564'69637469;
constexpr double kOutsideBand = 0.05;

// By condition, level and participant, with trials, those of the same three added up.
std::vector<HierarchicalCell> sorted_cells(std::span<const HierarchicalCell> cells) {
  std::vector<HierarchicalCell> sorted(cells.begin(), cells.end());
  std::erase_if(sorted, [](const HierarchicalCell& cell) { return cell.positive + cell.negative == 0; });
  const auto place = [](const HierarchicalCell& cell) {
    return std::tuple(cell.condition, cell.level, cell.participant);
  };
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&place](const HierarchicalCell& a, const HierarchicalCell& b) { return place(a) < place(b); });
  std::vector<HierarchicalCell> merged;
  for (const HierarchicalCell& cell : sorted) {
    if (merged.empty() || place(merged.back()) != place(cell)) {
      merged.push_back(cell);
      continue;
    }
    merged.back().positive += cell.positive;
    merged.back().negative += cell.negative;
  }
  return merged;
}

// The answers at one level: what is compared of them.
struct SharesOfPeople {
  double positive = 0, trials = 0, sum = 0, squares = 0;
  int people = 0;

  void add(double of_person, double trials_of_person) noexcept {
    const double share = of_person / trials_of_person;
    positive += of_person;
    trials += trials_of_person;
    sum += share;
    squares += share * share;
    ++people;
  }
  double share() const noexcept { return positive / trials; }
  double sd() const noexcept {
    return people < 2 ? kNaN : std::sqrt(std::max(0.0, squares - sum * sum / people) / (people - 1));
  }
};

double discrepancy_of(double positive, double trials, const LogRates& rates) {
  const double p = std::exp(rates.positive), q = std::exp(rates.negative);
  const double off = positive - trials * p;
  return off * off / (trials * p * q);
}

PredictiveBand band_of(double observed, std::vector<double> drawn) {
  constexpr double kRounding = 1e-12;  // equal counts may differ by so much in their moments
  const SampleQuantiles quantiles(std::move(drawn));
  PredictiveBand band{observed, quantiles.at(kOutsideBand / 2), quantiles.at(1 - kOutsideBand / 2), BandStatus::inside};
  if (observed < band.low - kRounding) band.status = BandStatus::below;
  if (observed > band.high + kRounding) band.status = BandStatus::above;
  return band;
}

}  // namespace

PosteriorDraws::PosteriorDraws(std::span<const HierarchicalCell> cells, const HierarchicalModel& model,
                               const HierarchicalPlace& place, std::size_t draws, std::uint64_t seed)
    : draws_(draws), conditions_(place.mu.size()) {
  HierarchicalLikelihood likelihood(cells, model.response, model.shared);
  const std::size_t participants = likelihood.participants();
  std::vector<std::vector<HierarchicalCell>> answers(participants * conditions_);
  for (const HierarchicalCell& cell : cells)
    answers[static_cast<std::size_t>(cell.participant) * conditions_ + static_cast<std::size_t>(cell.condition)]
        .push_back(cell);
  ln_s_.resize(answers.size() * draws);
  criterion_.resize(ln_s_.size());
  std::vector<ExperimentStream> streams;
  for (std::size_t p = 0; p < participants; ++p) streams.emplace_back(seed, kDrawPurpose, 0, p);
  ExperimentStream beginnings(seed, kDrawPurpose, 1);
  NodeOffset offset{open_uniform(beginnings.next()), open_uniform(beginnings.next())};
  WithinPerson within(model.response, model.shared);
  likelihood.at(place);  // so that spacings stay the same from now on
  std::vector<std::vector<double>> numbers(participants);
  for (std::size_t begun = 0; begun < draws; begun += kDrawsOfARow) {
    stop_if_requested();
    const std::size_t count = std::min(kDrawsOfARow, draws - begun);
    for (std::size_t p = 0; p < participants; ++p) {
      numbers[p].clear();
      for (std::size_t i = 0; i < count; ++i) numbers[p].push_back(open_uniform(streams[p].next()));
    }
    const auto deviations = likelihood.deviations(place, offset, numbers);
    for (std::size_t p = 0; p < participants; ++p)
      for (std::size_t i = 0; i < count; ++i)
        for (std::size_t c = 0; c < conditions_; ++c) {
          const double ln_s = place.mu[c] + deviations[p][i].u, criterion = place.kappa[c] + deviations[p][i].w;
          const double from = open_uniform(streams[p].next()), number = open_uniform(streams[p].next());
          const std::size_t to = of(p, c, begun + i);
          ln_s_[to] = ln_s + within.drawn(answers[p * conditions_ + c], place.tv_of(c), ln_s, criterion, from, number);
          criterion_[to] = criterion;
        }
    offset = {fraction(offset.u + kPlasticU), fraction(offset.w + kPlasticW)};
  }
}

int PredictiveCheck::bands() const noexcept {
  int count = 0;
  for (const PredictiveRow& row : rows)
    for (const PredictiveBand* band : {&row.share, &row.between}) count += band->status != BandStatus::one_person;
  return count;
}

int PredictiveCheck::outside() const noexcept {
  int count = 0;
  for (const PredictiveRow& row : rows)
    for (const PredictiveBand* band : {&row.share, &row.between})
      count += band->status == BandStatus::below || band->status == BandStatus::above;
  return count;
}

int PredictiveCheck::outside_by_chance() const {
  const BinomialTable table = binomial_table(bands(), kOutsideBand);
  double above = 1;
  for (std::size_t i = 0; i < table.probability.size(); ++i) {
    above -= table.probability[i];
    if (above <= 0.05) return table.first + static_cast<int>(i);
  }
  return bands();
}

PredictiveCheck predictive_check(std::span<const HierarchicalCell> cells, const HierarchicalModel& model,
                                 const HierarchicalPlace& place, int draws, std::uint64_t seed) {
  const std::vector<HierarchicalCell> given = sorted_cells(cells);
  PredictiveCheck check;
  check.draws = draws;
  std::vector<std::size_t> row_of;  // by cell
  std::vector<SharesOfPeople> observed;
  for (const HierarchicalCell& cell : given) {
    const auto condition = static_cast<std::size_t>(cell.condition);
    if (check.rows.empty() || check.rows.back().condition != condition || check.rows.back().level != cell.level) {
      check.rows.push_back({condition, cell.level, 0, 0, {}, {}});
      observed.emplace_back();
    }
    row_of.push_back(check.rows.size() - 1);
    observed.back().add(cell.positive, cell.positive + cell.negative);
  }
  const PosteriorDraws people(cells, model, place, static_cast<std::size_t>(draws), seed);
  std::vector<std::vector<double>> shares(check.rows.size()), between(check.rows.size());
  std::vector<double> discrepancies, drawn_discrepancies;
  int as_large = 0;
  for (int draw = 0; draw < draws; ++draw) {
    stop_if_requested();
    std::vector<SharesOfPeople> drawn(check.rows.size());
    double of_observed = 0, of_drawn = 0;
    for (std::size_t i = 0; i < given.size(); ++i) {
      const HierarchicalCell& cell = given[i];
      const auto p = static_cast<std::size_t>(cell.participant), c = static_cast<std::size_t>(cell.condition);
      const auto number = static_cast<std::size_t>(draw);
      const LogRates rates = log_rates(model.response, cell.level, people.ln_s(p, c, number),
                                       people.criterion(p, c, number), model.shared.lapse);
      const double trials = cell.positive + cell.negative;
      ExperimentStream stream(seed, kAnswerPurpose, static_cast<std::uint64_t>(draw), i);
      const int positive = BinomialSampler(static_cast<int>(trials), std::min(std::exp(rates.positive), 1.0))
                               .at(open_uniform(stream.next()));
      drawn[row_of[i]].add(positive, trials);
      of_observed += discrepancy_of(cell.positive, trials, rates);
      of_drawn += discrepancy_of(positive, trials, rates);
    }
    for (std::size_t row = 0; row < drawn.size(); ++row) {
      shares[row].push_back(drawn[row].share());
      between[row].push_back(drawn[row].sd());
    }
    discrepancies.push_back(of_observed);
    drawn_discrepancies.push_back(of_drawn);
    as_large += of_drawn >= of_observed ? 1 : 0;
  }
  for (std::size_t row = 0; row < check.rows.size(); ++row) {
    PredictiveRow& one = check.rows[row];
    one.participants = observed[row].people;
    one.trials = observed[row].trials;
    one.share = band_of(observed[row].share(), std::move(shares[row]));
    if (one.participants > 1) one.between = band_of(observed[row].sd(), std::move(between[row]));
  }
  check.observed = SampleQuantiles(std::move(discrepancies)).at(0.5);
  check.drawn = SampleQuantiles(std::move(drawn_discrepancies)).at(0.5);
  check.p = (1.0 + as_large) / (1.0 + draws);
  return check;
}

}  // namespace jnd
