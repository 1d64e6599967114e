#include "analysis/hierarchical/hierarchical_likelihood.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include "analysis/hierarchical/hierarchical_evaluation.h"
#include "analysis/hierarchical/person_mode.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

namespace {

// Nodes: a larger lattice is not kept for later, and laid out anew where that is so many times what is needed.
constexpr std::size_t kMostKept = 10'000, kMostWaste = 3;
// A standard deviation below this is 0: ln L is even in it, and differs from its value at 0 by less than rounding.
constexpr double kLeastSpread = 1e-5;
constexpr double kFirstReach = 7;  // standard deviations of the posterior, about the mode
// Of the least standard error that a cell's answers can have of ln s, and of the criterion: Lagrange's polynomial through
// a likelihood errs by 2e-8, and through the logarithm of one where steps are this share of one answer's standard error.
constexpr double kLatticeStepS = 0.3, kLogarithmStepK = 0.16, kLogarithmStepKOfIndependent = 0.4;
constexpr double kAveraged = 2;  // steps: a narrower spread does not average out what polynomials err by

// Posteriors that are less like a normal distribution take more nodes for the same error.
double fineness_of(ResponseModel model) {
  switch (model) {
    case ResponseModel::yes_no:
      return 1;
    case ResponseModel::differencing:
      return 1.15;
    case ResponseModel::independent:
    case ResponseModel::choice:
      return 1.35;
  }
  return 1;
}

HierarchicalPlace rounded(HierarchicalPlace place) {
  const auto settle = [](double& spread) {
    if (spread < kLeastSpread) spread = 0;
  };
  for (double* spread : {&place.tu, &place.tv, &place.tw}) settle(*spread);
  for (double& spread : place.own_tv) settle(spread);
  return place;
}

LatticeQuestion question_of(const HierarchicalCell& cell) {
  return {cell.level, cell.second_half};
}

std::vector<std::vector<LatticeQuestion>> questions_of(std::span<const HierarchicalCell> cells) {
  std::vector<std::vector<LatticeQuestion>> questions;
  for (const HierarchicalCell& cell : cells) {
    questions.resize(std::max(questions.size(), static_cast<std::size_t>(cell.condition) + 1));
    questions[static_cast<std::size_t>(cell.condition)].push_back(question_of(cell));
  }
  for (std::vector<LatticeQuestion>& of : questions) {
    std::sort(of.begin(), of.end());
    of.erase(std::unique(of.begin(), of.end()), of.end());
  }
  return questions;
}

// Of a ladder of steps, a rung no longer than this one: neighbouring places have the same lattice.
double rung_below(double step) {
  return std::exp2(std::floor(2 * std::log2(step)) / 2);
}

// The number of the levels that are one with this one.
int neighbours_of(double level, double largest) noexcept {
  constexpr double kShare = 0.05, kSmall = 0.1, kStep = 0.01;
  if (level == 0) return 0;
  const double share = std::abs(level) / largest;
  const double number = share < kSmall ? share / kStep : kSmall / kStep + std::log(share / kSmall) / kShare;
  return static_cast<int>(std::copysign(std::floor(number) + 1, level));
}

}  // namespace

bool pool_levels(std::vector<HierarchicalCell>& cells) {
  std::map<int, std::set<double>> levels;  // by condition
  double largest = 0;
  for (const HierarchicalCell& cell : cells) {
    levels[cell.condition].insert(cell.level);
    largest = std::max(largest, std::abs(cell.level));
  }
  if (std::all_of(levels.begin(), levels.end(), [](const auto& of) { return of.second.size() <= kMostLevels; }))
    return false;
  struct Bin {
    double sum = 0, trials = 0;
  };
  std::map<int, Bin> bins;
  for (const HierarchicalCell& cell : cells) {
    Bin& bin = bins[neighbours_of(cell.level, largest)];
    bin.sum += cell.counts().trials() * cell.level;
    bin.trials += cell.counts().trials();
  }
  std::map<std::tuple<int, int, double, bool>, HierarchicalCell> pooled;
  for (const HierarchicalCell& cell : cells) {
    const Bin& bin = bins[neighbours_of(cell.level, largest)];
    const double level = bin.trials > 0 ? bin.sum / bin.trials : cell.level;
    const auto [place, added] = pooled.try_emplace({cell.participant, cell.condition, level, cell.second_half}, cell);
    place->second.level = level;
    if (added) continue;
    place->second.positive += cell.positive;
    place->second.negative += cell.negative;
    place->second.sure_positive += cell.sure_positive;
    place->second.sure_negative += cell.sure_negative;
  }
  cells.clear();
  for (const auto& [where, cell] : pooled) cells.push_back(cell);
  return true;
}

HierarchicalPlace& HierarchicalPlace::operator+=(const HierarchicalPlace& other) noexcept {
  for (std::size_t c = 0; c < mu.size(); ++c) {
    mu[c] += other.mu[c];
    kappa[c] += other.kappa[c];
  }
  for (std::size_t c = 0; c < own_tv.size(); ++c) own_tv[c] += other.own_tv[c];
  tu += other.tu;
  tv += other.tv;
  tw += other.tw;
  rho += other.rho;
  return *this;
}

HierarchicalLikelihood::HierarchicalLikelihood(std::span<const HierarchicalCell> cells, ResponseModel model,
                                               const SharedParameters& shared, double fineness)
    : model_(model),
      shared_(shared),
      reach_(fineness),
      fineness_(fineness * fineness_of(model)),
      questions_(questions_of(cells)) {
  std::size_t participants = 0;
  for (const HierarchicalCell& cell : cells)
    participants = std::max(participants, static_cast<std::size_t>(cell.participant) + 1);
  conditions_ = questions_.size();
  std::vector<std::vector<QuestionAnswers>> answers(participants * conditions_);
  for (const HierarchicalCell& cell : cells) {
    const auto condition = static_cast<std::size_t>(cell.condition);
    const std::vector<LatticeQuestion>& asked = questions_[condition];
    const auto question =
        static_cast<std::size_t>(std::lower_bound(asked.begin(), asked.end(), question_of(cell)) - asked.begin());
    std::vector<QuestionAnswers>& of = answers[static_cast<std::size_t>(cell.participant) * conditions_ + condition];
    auto known =
        std::find_if(of.begin(), of.end(), [question](const QuestionAnswers& one) { return one.question == question; });
    if (known == of.end()) known = of.insert(of.end(), {question, {}});
    known->counts += cell.counts();
  }
  people_.resize(participants);
  for (std::size_t i = 0; i < participants; ++i) people_[i].number = i;
  for (std::size_t c = 0; c < conditions_; ++c) {
    Lattice& lattice = lattices_.emplace_back().emplace_back(
        Lattice{{model, questions_[c], shared, {}}, {model, questions_[c], shared, {}}, {}, {}, false});
    for (std::size_t i = 0; i < participants; ++i) lattice.cells.emplace_back(std::move(answers[i * conditions_ + c]));
  }
}

void HierarchicalLikelihood::set_shared(const SharedParameters& shared) {
  if (shared == shared_) return;
  shared_ = shared;
  for (std::vector<Lattice>& of : lattices_) {
    of.erase(of.begin() + 1, of.end());
    of.front().responses.set_shared(shared);
    of.front().beside.set_shared(shared);
    for (CellLikelihood& cell : of.front().cells) cell.forget();
  }
}

void HierarchicalLikelihood::look_beside(const HierarchicalPlace& place, const SharedForm& by) {
  const double unit = model_ == ResponseModel::choice ? std::exp(place.mu.front()) : 1;
  beside_.clear();
  for (const SharedParameter which : kSharedParameters) {
    if (!by.has(which)) continue;
    SharedParameters shared = shared_;
    value_of(shared, which) += step_of(which, value_of(shared, which), unit);
    // Of lapses and over-dispersion the rest of a lattice stays.
    const bool rest = which == SharedParameter::lapse || which == SharedParameter::overdispersion;
    for (std::size_t c = 0; c < conditions_; ++c) {
      beside_.push_back({which, value_of(shared, which) - value_of(shared_, which), c,
                         rest ? responses(c) : ResponseLattice(model_, questions_[c], shared, responses(c).steps())});
      beside_.back().responses.set_shared(shared);
    }
  }
}

OfSharedParameters HierarchicalLikelihood::slope_by_shared(const Person& person, const Evaluation& at) {
  OfSharedParameters slope{};
  for (std::size_t c = 0; c < conditions_; ++c) {
    const CellLikelihood& answers = cell(person, c);
    const LatticeRange nodes = at.read_by(c, at.box);
    responses(c).extend(nodes);
    work_ += responses(c).worked();
    const double here = answers.weighted_sum(nodes, at.by_cell[c], responses(c));
    for (ResponsesBeside& beside : beside_) {
      if (beside.condition != c) continue;
      beside.responses.extend(nodes);
      work_ += beside.responses.worked();
      slope[static_cast<std::size_t>(beside.parameter)] +=
          (answers.weighted_sum(nodes, at.by_cell[c], beside.responses) - here) / beside.step;
      work_ += static_cast<double>(nodes.nodes() * answers.answers().size());
    }
  }
  return slope;
}

// How fine the lattice of a condition must be: by the least standard errors that anybody's answers could have about where
// they lie, and for the criterion, whose logarithms are read, by those of one answer.
LatticeSteps HierarchicalLikelihood::steps_about(std::size_t condition, const HierarchicalPlace& place) const {
  constexpr double kWidest = 1;  // standard error: where answers tell next to nothing a lattice is no coarser
  constexpr double kAround = 2;  // standard deviations of the posterior
  SharedParameters without_lapses = shared_;  // which a cell tells more without
  without_lapses.lapse = 0;
  double most_s = 0, most_k = 0;
  const double tv = place.tv_of(condition);
  std::vector<LevelTrials> design;
  for (const Person& person : people_) {
    design.clear();
    for (const QuestionAnswers& one : cell(person, condition).answers())
      if (one.counts.trials() > 0) design.push_back({questions_[condition][one.question].level, one.counts.trials()});
    const double mode_s = place.mu[condition] + person.mode_u, mode_k = place.kappa[condition] + person.mode_w;
    const double beside_s =
                     kAround * std::hypot(sd_with(place.tu, person.information_u), sd_with(tv, person.information_u)),
                 beside_k = kAround * sd_with(place.tw, person.information_w);
    for (const auto& [i, j] : {std::pair{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      const double s = mode_s + i * beside_s, k = mode_k + j * beside_k;
      double told_s = 0;
      for (const LevelTrials& level : design) {
        const LevelTrials one{level.level, 1};
        const CellInformation told = expected_information(model_, std::span(&one, 1), s, k, without_lapses);
        told_s += level.trials * told.s;
        most_k = std::max(most_k, told.k);
      }
      most_s = std::max(most_s, told_s);
    }
  }
  const double narrowest = std::min(kWidest, 1 / std::sqrt(most_s));
  LatticeSteps steps;
  steps.ln_s = rung_below(kLatticeStepS * narrowest / fineness_);
  if (std::hypot(place.tu, tv) < kAveraged * steps.ln_s) steps.ln_s /= 2;
  // Where the normal density of v is wide, the lattice of ln s may be coarser.
  const double product = tv * narrowest / std::hypot(tv, narrowest);  // the width of both together
  steps.ln_s *= rung_below(std::max(1.0, product / (steps.ln_s * fineness_)));
  const double of_answer = model_ == ResponseModel::independent ? kLogarithmStepKOfIndependent : kLogarithmStepK;
  if (choice()) return steps;
  steps.criterion = rung_below(of_answer * std::min(kWidest, 1 / std::sqrt(most_k)) / fineness_);
  if (place.tw < kAveraged * steps.criterion) steps.criterion /= 2;
  return steps;
}

void HierarchicalLikelihood::choose_lattices(const HierarchicalPlace& place) {
  for (std::size_t c = 0; c < conditions_; ++c) {
    const LatticeSteps steps = steps_about(c, place);
    std::vector<Lattice>& of = lattices_[c];
    const auto same = std::find_if(of.begin(), of.end(), [&](const Lattice& one) {
      return one.responses.steps().ln_s == steps.ln_s &&
             (choice() || (one.responses.steps().criterion == steps.criterion && !one.rows_at_nodes));
    });
    if (same != of.end()) {
      std::rotate(of.begin(), same, same + 1);
      continue;
    }
    constexpr std::size_t kMostLattices = 3;
    const ResponseLattice empty(model_, questions_[c], shared_, steps);
    Lattice fresh{empty, empty, {}, {}, false};
    for (const CellLikelihood& cell : of.front().cells) fresh.cells.emplace_back(cell.answers());
    const LatticeRange& range = of.front().responses.range();
    if (of.front().rows_at_nodes || range.empty() || range.nodes() > kMostKept) of.erase(of.begin());
    if (of.size() == kMostLattices) of.pop_back();
    of.insert(of.begin(), std::move(fresh));
  }
}

// Where nodes are put: about the most likely deviations of the person.
void HierarchicalLikelihood::locate(Person& person, const HierarchicalPlace& place) const {
  std::vector<PersonCell> cells;
  for (std::size_t c = 0; c < conditions_; ++c) {
    PersonCell& cell = cells.emplace_back();
    cell.mu = place.mu[c];
    cell.kappa = place.kappa[c];
    cell.tv = place.tv_of(c);
    for (const QuestionAnswers& one : this->cell(person, c).answers())
      cell.answers.push_back({questions_[c][one.question].level, one.counts});
  }
  const PersonMode mode = person_mode(cells, model_, shared_, {place.tu, place.tw, place.rho});
  person.mode_u = mode.u;
  person.mode_w = mode.w;
  person.information_u = mode.information_u;
  person.information_w = mode.information_w;
  person.correlation = mode.correlation;
  const double reach = kFirstReach * reach_;
  const auto about = [reach](double middle, double prior, double information) {
    const double sd = sd_with(prior, information);
    return Range{middle - reach * sd, middle + reach * sd};
  };
  person.u = about(mode.u, place.tu, mode.information_u);
  person.w = about(mode.w, place.tw, mode.information_w);
}

// Everybody's integrals, each handed to `each` while it stands in the evaluation.
template <typename Each>
void HierarchicalLikelihood::through_everybody(const HierarchicalPlace& place, Each&& each, const NodeOffset& offset,
                                               const SharedForm& by) {
  constexpr double kToLocate = 1500;  // nanoseconds a question that somebody answered
  // Of choices, whose rows are computed anew, and of derivatives by shared parameters: times what is counted.
  constexpr double kDearerChoice = 1.6, kDearerShared = 2.5;
  const double before = work_;
  for (Person& person : people_) {
    locate(person, place);
    for (std::size_t c = 0; c < conditions_; ++c)
      work_ += kToLocate * static_cast<double>(cell(person, c).answers().size());
  }
  for (std::vector<Lattice>& of : lattices_)
    for (Lattice& one : of) one.needed = {};
  std::vector<std::size_t> pending(people_.size());
  std::iota(pending.begin(), pending.end(), 0);
  while (!pending.empty()) {
    choose_lattices(place);  // not the one whose rows are the nodes of the people before
    const std::vector<std::size_t> people = alike(pending, place);
    Evaluation at = prepared(place, offset, people);
    at.back_to_cells = by.any();
    if (by.any()) look_beside(place, by);
    for (const std::size_t i : people) {
      if (!settled(people_[i], at)) break;
      go_back(at);
      each(i, at);
      if (!fine_enough(people_[i], at)) break;
      for (std::size_t c = 0; c < conditions_; ++c)
        if (at.rows_at_nodes[c]) cell(people_[i], c).forget();
      std::erase(pending, i);
    }
  }
  for (std::vector<Lattice>& of : lattices_) {
    Lattice& now = of.front();
    if (now.responses.range().nodes() <= std::max(kMostKept, kMostWaste * now.needed.nodes())) continue;
    now.responses.forget();
    for (CellLikelihood& cell : now.cells) cell.forget();
  }
  work_ = before + (work_ - before) * (choice() ? kDearerChoice : 1) * (by.any() ? kDearerShared : 1);
}

HierarchicalLikelihood::Value HierarchicalLikelihood::at(const HierarchicalPlace& given, const SharedForm& by) {
  const HierarchicalPlace place = rounded(given);
  std::vector<double> values(people_.size());
  std::vector<HierarchicalPlace> slopes(people_.size());
  std::vector<OfSharedParameters> by_shared(people_.size());
  const auto each = [&](std::size_t i, const Evaluation& at) {
    values[i] = log_of(people_[i], at);
    slopes[i] = slope_of(at);
    if (by.any()) by_shared[i] = slope_by_shared(people_[i], at);
  };
  through_everybody(place, each, {}, by);
  Value value;
  value.slope.mu.assign(conditions_, 0);
  value.slope.kappa.assign(conditions_, 0);
  value.slope.own_tv.assign(place.own_tv.size(), 0);
  for (std::size_t i = 0; i < people_.size(); ++i) {
    value.log_likelihood += values[i];
    if (!std::isfinite(values[i])) continue;
    value.slope += slopes[i];
    for (std::size_t k = 0; k < by_shared[i].size(); ++k) value.by_shared[k] += by_shared[i][k];
  }
  return value;
}

std::vector<CellInformation> HierarchicalLikelihood::told_by_one(const HierarchicalPlace& place) const {
  std::vector<CellInformation> told;
  for (std::size_t c = 0; c < conditions_; ++c) {
    std::vector<LevelTrials> design;
    for (const LatticeQuestion& question : questions_[c]) design.push_back({question.level, 0});
    for (const CellLikelihood& cell : lattices_[c].front().cells)
      for (const QuestionAnswers& one : cell.answers())
        design[one.question].trials += one.counts.trials() / static_cast<double>(people_.size());
    told.push_back(expected_information(model_, design, place.mu[c], place.kappa[c], shared_));
  }
  return told;
}

std::vector<PersonPosterior> HierarchicalLikelihood::posteriors(const HierarchicalPlace& given) {
  const HierarchicalPlace place = rounded(given);
  std::vector<PersonPosterior> posteriors(people_.size());
  through_everybody(place, [&](std::size_t person, const Evaluation& at) {
    PersonPosterior& posterior = posteriors[person];
    posterior = {};
    for (std::size_t c = 0; c < conditions_; ++c) {
      // A weight times the derivative by it is the posterior probability of its node.
      const LatticeKernel& over_s = at.over_s[c];
      double mean = 0, square = 0;
      for (int u = at.box.u0; u <= at.box.u1; ++u)
        for (std::size_t tap = 0; tap < over_s.taps(); ++tap) {
          const double share =
              over_s.weights(u)[tap] * at.by_s[c][static_cast<std::size_t>(u - at.box.u0) * over_s.taps() + tap];
          const double ln_s = (over_s.start(u) + static_cast<int>(tap)) * responses(c).steps().ln_s;
          mean += share * ln_s;
          square += share * ln_s * ln_s;
        }
      posterior.mean.push_back(mean);
      posterior.sd.push_back(std::sqrt(std::max(0.0, square - mean * mean)));
    }
    posterior.w = at.moments().w;
  });
  return posteriors;
}

std::vector<std::vector<PersonDeviation>> HierarchicalLikelihood::deviations(
    const HierarchicalPlace& given, const NodeOffset& offset, std::span<const std::vector<double>> numbers) {
  const HierarchicalPlace place = rounded(given);
  std::vector<std::vector<PersonDeviation>> deviations(people_.size());
  std::vector<double> below;  // of every node the sum up to it
  const auto choose = [&](std::size_t person, const Evaluation& at) {
    below.clear();
    double sum = 0;
    for (const double one : at.joint) below.push_back(sum += std::max(one, 0.0));
    deviations[person].clear();
    for (const double number : numbers[person]) {
      const auto node = static_cast<std::size_t>(
          std::min(std::upper_bound(below.begin(), below.end(), number * sum), below.end() - 1) - below.begin());
      deviations[person].push_back(
          {at.u(at.box.u0 + static_cast<int>(node % at.wide)), at.w(at.box.w0 + static_cast<int>(node / at.wide))});
    }
  };
  through_everybody(place, choose, offset);
  return deviations;
}

}  // namespace jnd
