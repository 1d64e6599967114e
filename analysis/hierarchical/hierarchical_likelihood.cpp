#include "analysis/hierarchical/hierarchical_likelihood.h"

#include <algorithm>
#include <cmath>
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

// A standard deviation below this is 0: ln L is even in it, and differs from its value at 0 by less than rounding.
constexpr double kLeastSpread = 1e-5;
// Nodes a standard deviation of the posterior apart: the error of the sum is exp(-2 pi^2), 3e-9. The integrand may end
// where it has fallen to that share of its peak; a range is cut a little further out for the next evaluation.
constexpr double kSpacing = 1, kLogEdge = -19.6, kLogCut = -22;
constexpr double kFirstReach = 7,
                 kFurthest = 8;    // standard deviations: of the first range about the mode, of any about 0
constexpr double kFollowed = 5.9;  // standard deviations of v
constexpr double kGrowth = 0.4;    // of its width, by which a range grows at an end
constexpr double kClosest = 0.95;  // the greatest correlation that nodes are placed for
// Of the least standard error that a cell's answers can have of ln s, and of the criterion: Lagrange's polynomial through
// a likelihood errs by 2e-8, and through the logarithm of one where steps are this share of one answer's standard error.
constexpr double kLatticeStepS = 0.2, kLatticeStepK = 0.17, kLogarithmStepK = 0.12;

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
  for (double* spread : {&place.tu, &place.tv, &place.tw})
    if (*spread < kLeastSpread) *spread = 0;
  return place;
}

LatticeQuestion question_of(const HierarchicalCell& cell) {
  return {cell.level, cell.second_half};
}

std::vector<LatticeQuestion> questions_of(std::span<const HierarchicalCell> cells) {
  std::vector<LatticeQuestion> questions;
  for (const HierarchicalCell& cell : cells) questions.push_back(question_of(cell));
  std::sort(questions.begin(), questions.end());
  questions.erase(std::unique(questions.begin(), questions.end()), questions.end());
  return questions;
}

// Independent answers that would tell as much as these, which are alike (Kish's design effect).
double independent_trials(const QuestionAnswers& answers, double overdispersion) {
  const double n = answers.counts.trials();
  return n / (1 + std::max(0.0, n - 1) * overdispersion);
}

}  // namespace

HierarchicalPlace& HierarchicalPlace::operator+=(const HierarchicalPlace& other) noexcept {
  for (std::size_t c = 0; c < mu.size(); ++c) {
    mu[c] += other.mu[c];
    kappa[c] += other.kappa[c];
  }
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
      fineness_(fineness * fineness_of(model)),
      questions_(questions_of(cells)),
      responses_(model, questions_, shared, {}) {
  std::size_t participants = 0;
  for (const HierarchicalCell& cell : cells) {
    participants = std::max(participants, static_cast<std::size_t>(cell.participant) + 1);
    conditions_ = std::max(conditions_, static_cast<std::size_t>(cell.condition) + 1);
  }
  std::vector<std::vector<QuestionAnswers>> answers(participants * conditions_);
  for (const HierarchicalCell& cell : cells) {
    const auto question = static_cast<std::size_t>(
        std::lower_bound(questions_.begin(), questions_.end(), question_of(cell)) - questions_.begin());
    std::vector<QuestionAnswers>& of =
        answers[static_cast<std::size_t>(cell.participant) * conditions_ + static_cast<std::size_t>(cell.condition)];
    auto known =
        std::find_if(of.begin(), of.end(), [question](const QuestionAnswers& one) { return one.question == question; });
    if (known == of.end()) known = of.insert(of.end(), {question, {}});
    known->counts += cell.counts();
  }
  people_.resize(participants);
  for (std::size_t i = 0; i < answers.size(); ++i) people_[i / conditions_].cells.emplace_back(std::move(answers[i]));
}

void HierarchicalLikelihood::begin_like(const HierarchicalLikelihood& rougher) {
  set_shared(rougher.shared_);
  before_ = rougher.before_;
  const double times = std::min(fineness_, 1.0) / std::min(rougher.fineness_, 1.0);
  const auto widened = [times](const Range& range) {
    const double middle = (range.low + range.high) / 2, reach = times * (range.high - range.low) / 2;
    return Range{middle - reach, middle + reach};
  };
  for (std::size_t i = 0; i < people_.size(); ++i) {
    const Person& from = rougher.people_[i];
    Person& to = people_[i];
    to.u = widened(from.u);
    to.w = widened(from.w);
    to.information_u = from.information_u;
    to.information_w = from.information_w;
    to.correlation = from.correlation;
  }
}

void HierarchicalLikelihood::set_shared(const SharedParameters& shared) {
  if (shared == shared_) return;
  // Posteriors may be narrower with others: nodes are put anew.
  constexpr double kFar = 0.03;
  for (const SharedParameter which : kSharedParameters) {
    const double now = value_of(shared_, which), then = value_of(shared, which);
    if (now != then && !(std::abs(then - now) < kFar)) before_ = {};
  }
  shared_ = shared;
  responses_.set_shared(shared);
  for (Person& person : people_)
    for (CellLikelihood& cell : person.cells) cell.forget();
}

void HierarchicalLikelihood::look_beside(const HierarchicalPlace& place, const SharedForm& by) {
  const double unit = model_ == ResponseModel::choice ? std::exp(place.mu.front()) : 1;
  std::size_t i = 0;
  for (const SharedParameter which : kSharedParameters) {
    if (!by.has(which)) continue;
    SharedParameters shared = shared_;
    value_of(shared, which) += step_of(which, value_of(shared, which), unit);
    if (i == beside_.size()) beside_.push_back({which, 0, responses_});
    ResponsesBeside& one = beside_[i++];
    one.parameter = which;
    one.step = value_of(shared, which) - value_of(shared_, which);
    one.responses = responses_;
    one.responses.set_shared(shared);
  }
  beside_.erase(beside_.begin() + static_cast<std::ptrdiff_t>(i), beside_.end());
}

OfSharedParameters HierarchicalLikelihood::slope_by_shared(const Person& person, const Evaluation& at) {
  OfSharedParameters slope{};
  for (std::size_t c = 0; c < conditions_; ++c) responses_.extend(at.read_by(c, at.box));
  for (ResponsesBeside& beside : beside_) beside.responses.lay_out(responses_.range());
  for (std::size_t c = 0; c < conditions_; ++c) {
    const CellLikelihood& cell = person.cells[c];
    const LatticeRange nodes = at.read_by(c, at.box);
    const double here = cell.weighted_sum(nodes, at.by_cell[c], responses_);
    for (const ResponsesBeside& beside : beside_)
      slope[static_cast<std::size_t>(beside.parameter)] +=
          (cell.weighted_sum(nodes, at.by_cell[c], beside.responses) - here) / beside.step;
  }
  return slope;
}

// The least standard errors that the answers of a cell could have about the place, or where logarithms are read those of
// one answer for the criterion: how fine a lattice must be.
void HierarchicalLikelihood::look_how_narrow(const HierarchicalPlace& place) {
  SharedParameters without_lapses = shared_;  // which a cell tells more without
  without_lapses.lapse = 0;
  double most_s = 0, most_k = 0;
  for (std::size_t c = 0; c < conditions_; ++c) {
    std::vector<LevelTrials> design;  // the most that anybody has
    for (const LatticeQuestion& question : questions_) design.push_back({question.level, 0});
    for (const Person& person : people_)
      for (const QuestionAnswers& one : person.cells[c].answers())
        design[one.question].trials = std::max(design[one.question].trials, one.counts.trials());
    const double unit = model_ == ResponseModel::choice ? std::exp(place.mu[c]) : 1;
    for (const double s : {-1.0, -0.5, 0.0, 0.5, 1.0})
      for (const double k : {-0.8, 0.0, 0.8}) {
        const CellInformation told =
            expected_information(model_, design, place.mu[c] + s, place.kappa[c] + k * unit, without_lapses);
        most_s = std::max(most_s, told.s);
        if (!responses_.smooth()) most_k = std::max(most_k, told.k);
        for (const LevelTrials& level : design)
          if (level.trials > 0 && responses_.smooth()) {
            const LevelTrials one{level.level, 1};
            most_k = std::max(most_k, expected_information(model_, std::span(&one, 1), place.mu[c] + s,
                                                           place.kappa[c] + k * unit, without_lapses)
                                          .k);
          }
      }
  }
  narrowest_ = 1 / std::sqrt(most_s);
  finest_.ln_s = kLatticeStepS * narrowest_ / fineness_;
  finest_.criterion = (responses_.smooth() ? kLogarithmStepK : kLatticeStepK) / std::sqrt(most_k) / fineness_;
}

// Where the normal density of v is wide, the lattice of ln s may be coarser.
void HierarchicalLikelihood::choose_lattice(const HierarchicalPlace& place) {
  if (finest_.ln_s == 0) look_how_narrow(place);
  constexpr double kTooFine = 1.6;  // times: then the lattice is laid out anew
  const double product = place.tv * narrowest_ / std::hypot(place.tv, narrowest_);  // the width of both together
  const double step = finest_.ln_s * std::max(1.0, std::floor(product / (finest_.ln_s * fineness_)));
  const double now = responses_.steps().ln_s;
  if (now > 0 && step >= now && step <= kTooFine * now) return;
  responses_ = ResponseLattice(model_, questions_, shared_, {step, finest_.criterion});
  for (Person& person : people_)
    for (CellLikelihood& cell : person.cells) cell.forget();
}

// Where nodes are put: about the most likely deviations of the person.
void HierarchicalLikelihood::locate(Person& person, const HierarchicalPlace& place) const {
  std::vector<PersonCell> cells;
  for (std::size_t c = 0; c < conditions_; ++c) {
    PersonCell& cell = cells.emplace_back();
    cell.mu = place.mu[c];
    cell.kappa = place.kappa[c];
    for (const QuestionAnswers& one : person.cells[c].answers())
      cell.answers.push_back({questions_[one.question].level, one.counts});
  }
  const PersonMode mode = person_mode(cells, model_, shared_, {place.tu, place.tv, place.tw, place.rho});
  person.information_u = mode.information_u;
  person.information_w = mode.information_w;
  person.correlation = mode.correlation;
  const double reach = kFirstReach * std::min(fineness_, 1.0);
  const auto about = [reach](double middle, double prior, double information) {
    const double sd = prior > 0 ? 1 / std::sqrt(1 / (prior * prior) + information) : 0;
    return Range{middle - reach * sd, middle + reach * sd};
  };
  person.u = about(mode.u, place.tu, mode.information_u);
  person.w = about(mode.w, place.tw, mode.information_w);
}

// Those whose nodes lie nowhere yet, or so far from where the place has moved them that another range would have to
// grow towards them.
void HierarchicalLikelihood::look_around(const HierarchicalPlace& place) {
  constexpr double kFar = 1.5;  // standard deviations of a person's posterior
  const bool anew = before_.mu.empty() || (place.tu > 0) != (before_.tu > 0) || (place.tw > 0) != (before_.tw > 0);
  double moved_s = 0, moved_k = 0;
  for (std::size_t c = 0; c < conditions_ && !anew; ++c) {
    moved_s = std::max(moved_s, std::abs(place.mu[c] - before_.mu[c]));
    moved_k = std::max(moved_k, std::abs(place.kappa[c] - before_.kappa[c]));
  }
  const auto far = [](double moved, double prior, double information) {
    const double by_answers = moved * information;  // a prior holds a person back
    return by_answers * by_answers > kFar * kFar * (1 / (prior * prior) + information);
  };
  for (Person& person : people_)
    if (anew || (place.tu > 0 && far(moved_s, place.tu, person.information_u)) ||
        (place.tw > 0 && far(moved_k, place.tw, person.information_w)))
      locate(person, place);
  before_ = place;
}

std::vector<CellInformation> HierarchicalLikelihood::cell_information(const HierarchicalPlace& place) const {
  std::vector<CellInformation> information;
  std::vector<LevelTrials> design;
  for (const Person& person : people_)
    for (std::size_t c = 0; c < conditions_; ++c) {
      design.clear();
      for (const QuestionAnswers& one : person.cells[c].answers())
        design.push_back({questions_[one.question].level, independent_trials(one, shared_.overdispersion)});
      information.push_back(expected_information(model_, design, place.mu[c], place.kappa[c], shared_));
    }
  return information;
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
    const LatticeKernel& over_k = at.over_k[c];
    CellLikelihood& cell = person.cells[c];
    const LatticeRange needed = at.read_by(c, at.box);
    cell.cover(needed, responses_);
    at.first_s[c] = needed.s0;
    const std::size_t nodes = needed.wide(), stride = cell.range().wide();
    at.read[c].resize(nodes * at.high);
    at.by_criterion[c].resize(nodes * at.high);
    for (std::size_t j = 0; j < at.high; ++j) {
      const int w = at.box.w0 + static_cast<int>(j);
      interpolate_rows(cell.at(needed.s0, over_k.start(w)), stride, over_k.weights(w), over_k.by_centre(w), nodes,
                       &at.read[c][j * nodes], &at.by_criterion[c][j * nodes]);
    }
    if (responses_.smooth()) {
      exponentiate(at.read[c], cell.largest());
      for (std::size_t i = 0; i < at.read[c].size(); ++i) at.by_criterion[c][i] *= at.read[c][i];
    }
    at.inner[c].resize(at.wide * at.high);
    weighted_sums(at.rows_of(c), at.read[c].data(), at.inner[c].data());
  }
  at.lay_out_prior();
  at.multiply();
}

// Whether the integrand goes on beyond the nodes: then the participant's ranges grow.
bool HierarchicalLikelihood::grown(Person& person, const Evaluation& at) const {
  bool grew = false;
  const auto look = [this, &grew](const std::vector<double>& margin, Range& range, double prior) {
    const double edge = std::exp(kLogEdge * fineness_ * fineness_) * *std::max_element(margin.begin(), margin.end());
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

// False: the integrand is so much narrower than was thought that its nodes lie too far apart.
bool HierarchicalLikelihood::remember(Person& person, const Evaluation& at) const {
  if (!at.anything_left()) return true;
  const double share = std::exp(kLogCut * fineness_ * fineness_);
  const auto cut = [share](const std::vector<double>& margin, int first, double spacing, Range& range) {
    const double edge = share * *std::max_element(margin.begin(), margin.end());
    const auto large = [edge](double value) { return value >= edge; };
    const auto from = std::find_if(margin.begin(), margin.end(), large) - margin.begin();
    const auto to = margin.rend() - std::find_if(margin.rbegin(), margin.rend(), large) - 1;
    // A little beyond the last node that is too small to count.
    range = {(first + static_cast<double>(from) - 1.3) * spacing, (first + static_cast<double>(to) + 1.3) * spacing};
  };
  const Evaluation::Moments mean = at.moments();
  if (at.has_u) cut(at.in_u, at.box.u0, at.spacing_u, person.u);
  if (at.has_w) cut(at.in_w, at.box.w0, at.spacing_w, person.w);
  // What the answers tell, which stays the same under another prior. Of a prior so narrow that they tell nothing beside
  // it, what was known before is better. Where all lies on one node its variance is what was rounded, and half a
  // spacing is what is known of its width.
  constexpr double kTelling = 0.9, kNarrow = 0.5, kNarrowest = 1e-4;  // the last: standard deviations of the prior
  const double var_u = mean.uu - mean.u * mean.u, var_w = mean.ww - mean.w * mean.w;
  const auto learn = [](double variance, double prior, double spacing, double& information) {
    const double least = kNarrow * spacing * kNarrow * spacing, known = std::max(variance, least);
    if (known < kTelling * prior * prior) information = 1 / known - 1 / (prior * prior);
    return variance >= least || spacing < kNarrowest * prior;
  };
  const bool u_fits = !at.has_u || learn(var_u, at.place.tu, at.spacing_u, person.information_u),
             w_fits = !at.has_w || learn(var_w, at.place.tw, at.spacing_w, person.information_w);
  person.correlation = var_u > 0 && var_w > 0 ? (mean.uw - mean.u * mean.w) / std::sqrt(var_u * var_w) : 0;
  return u_fits && w_fits;
}

// Backwards: from the integral to the derivatives of its logarithm by the weights over ln s, and by the criteria.
void HierarchicalLikelihood::go_back(const Person& person, Evaluation& at) const {
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
      if (responses_.smooth())
        for (std::size_t i = 0; i < rows.nodes; ++i) at.by_read[i] *= at.read[c][j * rows.nodes + i];
      const int w = at.box.w0 + static_cast<int>(j);
      const LatticeKernel& over_k = at.over_k[c];
      add_to_rows(at.by_read.data(), rows.nodes, over_k.weights(w), rows.nodes,
                  &at.by_cell[c][cell_nodes.place(cell_nodes.s0, over_k.start(w))]);
    }
    if (responses_.smooth()) continue;
    for (int k = cell_nodes.k0; k <= cell_nodes.k1; ++k) {
      const double* values = person.cells[c].at(cell_nodes.s0, k);
      double* by = &at.by_cell[c][cell_nodes.place(cell_nodes.s0, k)];
      for (std::size_t i = 0; i < rows.nodes; ++i) by[i] *= values[i];
    }
  }
}

// The kernels for everybody's nodes, and some beside them.
HierarchicalLikelihood::Evaluation HierarchicalLikelihood::prepared(const HierarchicalPlace& place,
                                                                    const NodeOffset& offset) {
  Evaluation at(place, offset);
  double sd_u = place.tu, sd_w = place.tw, correlation = std::abs(place.rho);
  for (const Person& person : people_) {
    sd_u = std::min(sd_u, 1 / std::sqrt(1 / (place.tu * place.tu) + person.information_u));
    sd_w = std::min(sd_w, 1 / std::sqrt(1 / (place.tw * place.tw) + person.information_w));
    correlation = std::max(correlation, std::abs(person.correlation));
  }
  // Of correlated directions the sum errs with exp(-2 pi^2 (2 - 2 r)) too.
  const double spacing = kSpacing * std::sqrt(std::min(1.0, 2 - 2 * std::min(correlation, kClosest))) / fineness_;
  if (at.has_u) at.spacing_u = spacing * sd_u;
  if (at.has_w) at.spacing_w = spacing * sd_w;
  for (const Person& person : people_) {
    const Rectangle box = rectangle_of(person, at);
    at.all = {std::min(at.all.u0, box.u0), std::max(at.all.u1, box.u1), std::min(at.all.w0, box.w0),
              std::max(at.all.w1, box.w1)};
  }
  const Rectangle asked = at.all;
  const int more_u = at.has_u ? (at.all.u1 - at.all.u0) / 4 + 2 : 0,
            more_w = at.has_w ? (at.all.w1 - at.all.w0) / 4 + 2 : 0;
  at.all = {at.all.u0 - more_u, at.all.u1 + more_u, at.all.w0 - more_w, at.all.w1 + more_w};
  for (std::size_t c = 0; c < conditions_; ++c) {
    at.over_s.emplace_back(place.mu[c] + at.u(0), at.spacing_u, at.all.u0, at.all.u1, place.tv, responses_.steps().ln_s,
                           kFollowed * std::min(fineness_, 1.0));
    at.over_k.emplace_back(place.kappa[c] + at.w(0), at.spacing_w, at.all.w0, at.all.w1, 0,
                           responses_.steps().criterion, 0);
  }
  LatticeRange needed;
  for (std::size_t c = 0; c < conditions_; ++c) needed = needed.united(at.read_by(c, asked));
  responses_.cover(needed);
  at.by_s.resize(conditions_);
  at.by_kappa.resize(conditions_);
  at.by_cell.resize(conditions_);
  at.first_s.resize(conditions_);
  at.read.resize(conditions_);
  at.by_criterion.resize(conditions_);
  at.inner.resize(conditions_);
  return at;
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
  for (const CellLikelihood& cell : person.cells) value += cell.largest();
  return value;
}

HierarchicalPlace HierarchicalLikelihood::slope_of(const Evaluation& at) const {
  HierarchicalPlace slope;
  for (std::size_t c = 0; c < conditions_; ++c) {
    const LatticeKernel::Slopes slopes = at.over_s[c].slopes(at.box.u0, at.by_s[c]);
    slope.mu.push_back(slopes.by_centre);
    slope.tv += slopes.by_spread;
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
  choose_lattice(place);
  look_around(place);
  for (;;) {
    Evaluation at = prepared(place, offset);
    at.back_to_cells = by.any();
    if (by.any()) look_beside(place, by);
    std::size_t done = 0;
    for (; done < people_.size() && settled(people_[done], at); ++done) {
      go_back(people_[done], at);
      each(done, at);
      if (!remember(people_[done], at)) break;
    }
    if (done == people_.size()) return;
  }
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
  for (std::size_t i = 0; i < people_.size(); ++i) {
    value.log_likelihood += values[i];
    if (!std::isfinite(values[i])) continue;
    value.slope += slopes[i];
    for (std::size_t k = 0; k < by_shared[i].size(); ++k) {
      value.by_shared[k] += by_shared[i][k];
      value.squares_by_shared[k] += by_shared[i][k] * by_shared[i][k];
    }
  }
  return value;
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
          const double ln_s = (over_s.start(u) + static_cast<int>(tap)) * responses_.steps().ln_s;
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
