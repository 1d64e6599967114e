#include "analysis/hierarchical/posterior_draws.h"

#include <algorithm>
#include <cmath>

#include "analysis/numerics/binomial_sampler.h"
#include "analysis/numerics/experiment_stream.h"
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

}  // namespace jnd
