#include "analysis/hierarchical/hierarchical_likelihood.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "analysis/hierarchical/hierarchical_evaluation.h"
#include "analysis/hierarchical/person_mode.h"
#include "analysis/lattice/fast_functions.h"
#include "analysis/lattice/lattice_sums.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

namespace {

// Nodes: a larger lattice is not kept for later, and laid out anew where that is so many times what is needed.
constexpr std::size_t kMostKept = 10'000, kMostWaste = 3;
// A standard deviation below this is 0: ln L is even in it, and differs from its value at 0 by less than rounding.
constexpr double kLeastSpread = 1e-5;
// Nodes about a standard deviation of the posterior apart: the error of the sum is exp(-2 pi^2 / .95^2), 3e-10. The integrand may end
// where it has fallen to that share of its peak.
constexpr double kSpacing = 0.95, kLogEdge = -19.6;
constexpr double kFirstReach = 7,
                 kFurthest = 8;    // standard deviations: of the first range about the mode, of any about 0
constexpr double kFollowed = 5.9;  // standard deviations of v
constexpr double kGrowth = 0.4;    // of its width, by which a range grows at an end
constexpr double kClosest = 0.95;  // the greatest correlation that nodes are placed for
// Of the least standard error that a cell's answers can have of ln s, and of the criterion: Lagrange's polynomial through
// a likelihood errs by 2e-8, and through the logarithm of one where steps are this share of one answer's standard error.
constexpr double kLatticeStepS = 0.3, kLogarithmStepK = 0.16, kLogarithmStepKOfIndependent = 0.4;
constexpr double kAveraged = 2;      // steps: a narrower spread does not average out what polynomials err by
constexpr double kSmoothU = 0.33;    // in ln s: what likelihoods change within
constexpr double kMostNodesW = 512;  // where that would be less than all of them

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

double sd_with(double prior, double information) {
  return prior / std::sqrt(1 + prior * prior * information);
}

// Of a ladder of steps, a rung no longer than this one: neighbouring places have the same lattice.
double rung_below(double step) {
  return std::exp2(std::floor(2 * std::log2(step)) / 2);
}

}  // namespace

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
        Lattice{{model, questions_[c], shared, {}}, {model, questions_[c], shared, {}}, {}, {}});
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
    const double mode_s = place.mu[condition] + (person.u.low + person.u.high) / 2,
                 mode_k = place.kappa[condition] + (person.w.low + person.w.high) / 2;
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
             (choice() || one.responses.steps().criterion == steps.criterion);
    });
    if (same != of.end()) {
      std::rotate(of.begin(), same, same + 1);
      continue;
    }
    constexpr std::size_t kMostLattices = 3;
    const ResponseLattice empty(model_, questions_[c], shared_, steps);
    Lattice fresh{empty, empty, {}, {}};
    for (const CellLikelihood& cell : of.front().cells) fresh.cells.emplace_back(cell.answers());
    const LatticeRange& range = of.front().responses.range();
    if (choice() || range.empty() || range.nodes() > kMostKept) of.erase(of.begin());
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

HierarchicalLikelihood::Rectangle HierarchicalLikelihood::rectangle_of(const Person& person,
                                                                       const Evaluation& evaluation) const {
  // Beyond so many standard deviations of the prior nothing is left, however wide the range was under another one, or
  // wherever it lay.
  const auto nodes = [](const Range& range, double prior, double spacing) {
    const double furthest = kFurthest * prior;
    const bool elsewhere = range.low >= furthest || range.high <= -furthest;
    const double low = elsewhere ? -furthest : std::max(range.low, -furthest),
                 high = elsewhere ? furthest : std::min(range.high, furthest);
    return std::pair{static_cast<int>(std::floor(low / spacing)), static_cast<int>(std::ceil(high / spacing))};
  };
  Rectangle box;
  if (evaluation.has_u) std::tie(box.u0, box.u1) = nodes(person.u, evaluation.place.tu, evaluation.spacing_u);
  if (evaluation.has_w) std::tie(box.w0, box.w1) = nodes(person.w, evaluation.place.tw, evaluation.spacing_w);
  return box;
}

// Forwards: from the lattices to the integral of one participant.
void HierarchicalLikelihood::integrate(Person& person, Evaluation& at) {
  at.box = rectangle_of(person, at);
  at.wide = static_cast<std::size_t>(at.box.u1 - at.box.u0) + 1;
  at.high = static_cast<std::size_t>(at.box.w1 - at.box.w0) + 1;
  for (std::size_t c = 0; c < conditions_; ++c) {
    CellLikelihood& cell = this->cell(person, c);
    const LatticeRange needed = at.read_by(c, at.box);
    if (choice()) {
      lay_out_rows(c, needed, responses(c).steps().origin, responses(c).steps().criterion);
      work_ += cell.take(needed, responses(c), lattices_[c].front().beside);
    } else {
      work_ += cell.cover(needed, responses(c));
    }
    work_ += responses(c).worked();
    at.first_s[c] = needed.s0;
    const std::size_t nodes = needed.wide(), stride = cell.range().wide();
    at.read[c].resize(nodes * at.high);
    at.by_criterion[c].resize(nodes * at.high);
    for (std::size_t j = 0; j < at.high; ++j) {
      const int w = at.box.w0 + static_cast<int>(j);
      if (choice()) {
        std::copy_n(cell.at(needed.s0, w), nodes, &at.read[c][j * nodes]);
        std::copy_n(cell.slope_at(needed.s0, w), nodes, &at.by_criterion[c][j * nodes]);
        continue;
      }
      const LatticeKernel& over_k = at.over_k[c];
      interpolate_rows(cell.at(needed.s0, over_k.start(w)), stride, over_k.weights(w), over_k.by_centre(w), nodes,
                       &at.read[c][j * nodes], &at.by_criterion[c][j * nodes]);
    }
    exponentiate(at.read[c], cell.largest());
    for (std::size_t i = 0; i < at.read[c].size(); ++i) at.by_criterion[c][i] *= at.read[c][i];
    at.inner[c].resize(at.wide * at.high);
    weighted_sums(at.rows_of(c), at.read[c].data(), at.inner[c].data());
    work_ += static_cast<double>(at.wide * at.high * at.over_s[c].taps());
  }
  at.lay_out_prior();
  at.multiply();
}

// Whether the integrand goes on beyond the nodes: then the participant's ranges grow.
bool HierarchicalLikelihood::grown(Person& person, const Evaluation& at) const {
  bool grew = false;
  const auto look = [this, &grew](const std::vector<double>& margin, Range& range, double prior) {
    const double edge = std::exp(kLogEdge * reach_ * reach_) * *std::max_element(margin.begin(), margin.end());
    const double more = kGrowth * (range.high - range.low), furthest = kFurthest * prior;
    const bool below = margin.front() > edge && range.low > -furthest,
               above = margin.back() > edge && range.high < furthest;
    if (below) range.low -= more;
    if (above) range.high += more;
    grew = grew || below || above;
  };
  if (at.has_u) look(at.in_u, person.u, at.place.tu);
  if (at.has_w) look(at.in_w, person.w, at.place.tw);
  return grew;
}

// False: the integrand is so much narrower than was thought that its nodes lie too far apart. Where all lies on one node
// its variance is what was rounded, and half a spacing is what is known of its width.
bool HierarchicalLikelihood::fine_enough(Person& person, const Evaluation& at) const {
  if (!at.anything_left()) return true;
  constexpr double kNarrow = 0.5, kNarrowest = 0.02;  // the last: standard deviations of the prior
  const Evaluation::Moments mean = at.moments();
  const double share = std::exp(kLogEdge * reach_ * reach_);
  const auto look = [share](double variance, double prior, double spacing, double& information, Range& range,
                            const std::vector<double>& margin, int first) {
    const double least = kNarrow * spacing * kNarrow * spacing;
    if (variance >= least || spacing < kNarrowest * prior) return true;
    information = 1 / least - 1 / (prior * prior);
    // Where anything lies, and a little beyond.
    const double edge = share * *std::max_element(margin.begin(), margin.end());
    const auto large = [edge](double value) { return value >= edge; };
    const auto from = std::find_if(margin.begin(), margin.end(), large) - margin.begin();
    const auto to = margin.rend() - std::find_if(margin.rbegin(), margin.rend(), large) - 1;
    range = {(first + static_cast<double>(from) - 1.3) * spacing, (first + static_cast<double>(to) + 1.3) * spacing};
    return false;
  };
  const bool u_fits = !at.has_u || look(mean.uu - mean.u * mean.u, at.place.tu, at.spacing_u, person.information_u,
                                        person.u, at.in_u, at.box.u0);
  const bool w_fits = !at.has_w || look(mean.ww - mean.w * mean.w, at.place.tw, at.spacing_w, person.information_w,
                                        person.w, at.in_w, at.box.w0);
  return u_fits && w_fits;
}

// Backwards: from the integral to the derivatives of its logarithm by the weights over ln s, and by the criteria.
void HierarchicalLikelihood::go_back(Evaluation& at) const {
  for (std::size_t c = 0; c < conditions_; ++c) {
    at.adjoint = at.prior;
    for (std::size_t other = 0; other < conditions_; ++other)
      if (other != c)
        for (std::size_t i = 0; i < at.adjoint.size(); ++i) at.adjoint[i] *= at.inner[other][i];
    for (double& one : at.adjoint) one /= at.total;
    const LatticeRows rows = at.rows_of(c);
    at.by_s[c].resize(at.wide * rows.taps);
    at.by_kappa[c] =
        slopes_by_weights(rows, at.read[c].data(), at.by_criterion[c].data(), at.adjoint.data(), at.by_s[c].data());
    if (!at.back_to_cells) continue;
    const LatticeRange cell_nodes = at.read_by(c, at.box);
    at.by_cell[c].assign(cell_nodes.wide() * cell_nodes.high(), 0);
    for (std::size_t j = 0; j < at.high; ++j) {
      at.by_read.assign(rows.nodes, 0);
      add_slopes(rows, &at.adjoint[j * at.wide], at.by_read.data());
      for (std::size_t i = 0; i < rows.nodes; ++i) at.by_read[i] *= at.read[c][j * rows.nodes + i];
      const int w = at.box.w0 + static_cast<int>(j);
      if (choice()) {
        std::copy_n(at.by_read.data(), rows.nodes, &at.by_cell[c][cell_nodes.place(cell_nodes.s0, w)]);
        continue;
      }
      const LatticeKernel& over_k = at.over_k[c];
      add_to_rows(at.by_read.data(), rows.nodes, over_k.weights(w), rows.nodes,
                  &at.by_cell[c][cell_nodes.place(cell_nodes.s0, over_k.start(w))]);
    }
  }
}

// Of those people, the ones whose posteriors are about as wide as the narrowest: one of a guessing person would take
// thousands of the nodes of one who always knows.
std::vector<std::size_t> HierarchicalLikelihood::alike(std::vector<std::size_t> people,
                                                       const HierarchicalPlace& place) const {
  constexpr double kAsWide = 4;
  const auto keep = [&](double prior, double Person::*information) {
    const auto sd = [&](std::size_t i) { return sd_with(prior, people_[i].*information); };
    double least = kInf;
    for (const std::size_t i : people) least = std::min(least, sd(i));
    std::erase_if(people, [&](std::size_t i) { return sd(i) > kAsWide * least; });
  };
  keep(place.tu, &Person::information_u);
  keep(place.tw, &Person::information_w);
  return people;
}

// The kernels for those people's nodes, and some beside them.
HierarchicalLikelihood::Evaluation HierarchicalLikelihood::prepared(const HierarchicalPlace& place,
                                                                    const NodeOffset& offset,
                                                                    std::span<const std::size_t> people) {
  Evaluation at(place, offset);
  at.choice = choice();
  double sd_u = place.tu, sd_w = place.tw, correlation = std::abs(place.rho);
  for (const std::size_t i : people) {
    const Person& person = people_[i];
    sd_u = std::min(sd_u, sd_with(place.tu, person.information_u));
    sd_w = std::min(sd_w, sd_with(place.tw, person.information_w));
    correlation = std::max(correlation, std::abs(person.correlation));
  }
  // Of correlated directions the sum errs with exp(-2 pi^2 (2 - 2 r)) too.
  const double spacing = kSpacing * std::sqrt(std::min(1.0, 2 - 2 * std::min(correlation, kClosest))) / fineness_;
  // Where answers tell little, what they tell may change within less than a standard deviation.
  double smooth_w = 1;
  if (choice())
    smooth_w = std::exp(*std::min_element(place.mu.begin(), place.mu.end()) - std::hypot(place.tu, place.tv));
  if (at.has_u) at.spacing_u = std::min(spacing * sd_u, kSmoothU / fineness_);
  if (at.has_w)
    at.spacing_w = std::min(spacing * sd_w, std::max(smooth_w / fineness_, 2 * kFurthest * place.tw / kMostNodesW));
  for (const std::size_t i : people) {
    const Rectangle box = rectangle_of(people_[i], at);
    at.all = {std::min(at.all.u0, box.u0), std::max(at.all.u1, box.u1), std::min(at.all.w0, box.w0),
              std::max(at.all.w1, box.w1)};
  }
  const Rectangle asked = at.all;
  const int more_u = at.has_u ? (at.all.u1 - at.all.u0) / 4 + 2 : 0,
            more_w = at.has_w ? (at.all.w1 - at.all.w0) / 4 + 2 : 0;
  at.all = {at.all.u0 - more_u, at.all.u1 + more_u, at.all.w0 - more_w, at.all.w1 + more_w};
  for (std::size_t c = 0; c < conditions_; ++c) {
    at.over_s.emplace_back(place.mu[c] + at.u(0), at.spacing_u, at.all.u0, at.all.u1, place.tv_of(c),
                           responses(c).steps().ln_s, kFollowed * std::min(reach_, 1.0));
    if (choice()) {
      lay_out_rows(c, at.read_by(c, asked), place.kappa[c] + at.w(0), at.spacing_w);
      continue;
    }
    at.over_k.emplace_back(place.kappa[c] + at.w(0), at.spacing_w, at.all.w0, at.all.w1, 0,
                           responses(c).steps().criterion, 0);
    const LatticeRange needed = at.read_by(c, asked);
    lattices_[c].front().needed = lattices_[c].front().needed.united(needed);
    responses(c).cover(needed);
    work_ += responses(c).worked();
  }
  at.by_s.resize(conditions_);
  at.by_kappa.resize(conditions_);
  at.by_cell.resize(conditions_);
  at.first_s.resize(conditions_);
  at.read.resize(conditions_);
  at.by_criterion.resize(conditions_);
  at.inner.resize(conditions_);
  return at;
}

// Of choices: at the nodes of w, which are others at every place.
void HierarchicalLikelihood::lay_out_rows(std::size_t condition, const LatticeRange& needed, double origin,
                                          double spacing) {
  constexpr double kBeside = 1e-5;  // of a spread
  Lattice& lattice = lattices_[condition].front();
  LatticeSteps steps = lattice.responses.steps();
  if (steps.origin != origin || steps.criterion != spacing) {
    steps.origin = origin;
    steps.criterion = spacing;
    lattice.responses = ResponseLattice(model_, questions_[condition], shared_, steps);
    steps.origin += kBeside * std::exp(needed.s0 * steps.ln_s);
    lattice.beside = ResponseLattice(model_, questions_[condition], shared_, steps);
    for (CellLikelihood& cell : lattice.cells) cell.forget();
  }
  const LatticeRange both = lattice.responses.range().united(needed);
  lattice.responses.lay_out(both);
  lattice.beside.lay_out(both);
  work_ += lattice.responses.worked() + lattice.beside.worked();
}

// The integral of one participant over a range that holds all of it. False: the kernels do not reach so far.
bool HierarchicalLikelihood::settled(Person& person, Evaluation& at) {
  do {
    const Rectangle box = rectangle_of(person, at);
    if (box.u0 < at.all.u0 || box.u1 > at.all.u1 || box.w0 < at.all.w0 || box.w1 > at.all.w1) return false;
    integrate(person, at);
  } while (grown(person, at));
  return true;
}

double HierarchicalLikelihood::log_of(const Person& person, const Evaluation& at) const {
  if (!at.anything_left()) return -kInf;
  double value = std::log(at.total);
  for (std::size_t c = 0; c < conditions_; ++c) value += cell(person, c).largest();
  return value;
}

HierarchicalPlace HierarchicalLikelihood::slope_of(const Evaluation& at) const {
  HierarchicalPlace slope;
  for (std::size_t c = 0; c < conditions_; ++c) {
    const LatticeKernel::Slopes slopes = at.over_s[c].slopes(at.box.u0, at.by_s[c]);
    slope.mu.push_back(slopes.by_centre);
    if (at.place.own_tv.empty())
      slope.tv += slopes.by_spread;
    else
      slope.own_tv.push_back(slopes.by_spread);
    slope.kappa.push_back(at.by_kappa[c]);
  }
  const HierarchicalPlace& place = at.place;
  const Evaluation::Moments mean = at.moments();
  const double spare = 1 - place.rho * place.rho;
  const double aa = at.has_u ? mean.uu / (place.tu * place.tu) : 1, bb = at.has_w ? mean.ww / (place.tw * place.tw) : 1;
  const double ab = at.has_u && at.has_w ? mean.uw / (place.tu * place.tw) : place.rho;
  if (at.has_u) slope.tu = ((aa - place.rho * ab) / spare - 1) / place.tu;
  if (at.has_w) slope.tw = ((bb - place.rho * ab) / spare - 1) / place.tw;
  slope.rho = (place.rho * spare + ab * (1 + place.rho * place.rho) - place.rho * (aa + bb)) / (spare * spare);
  return slope;
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
  choose_lattices(place);
  for (std::vector<Lattice>& of : lattices_) of.front().needed = {};
  std::vector<std::size_t> pending(people_.size());
  std::iota(pending.begin(), pending.end(), 0);
  while (!pending.empty()) {
    const std::vector<std::size_t> people = alike(pending, place);
    Evaluation at = prepared(place, offset, people);
    at.back_to_cells = by.any();
    if (by.any()) look_beside(place, by);
    for (const std::size_t i : people) {
      if (!settled(people_[i], at)) break;
      go_back(at);
      each(i, at);
      if (!fine_enough(people_[i], at)) break;
      for (std::size_t c = 0; c < conditions_ && choice(); ++c) cell(people_[i], c).forget();
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
