#include "analysis/hierarchical/hierarchical_evaluation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

#include "analysis/lattice/fast_functions.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

namespace {

// Nodes about a standard deviation of the posterior apart: the error of the sum is exp(-2 pi^2 / .95^2), 3e-10. The integrand
// may end where it has fallen to that share of its peak.
constexpr double kSpacing = 0.95, kLogEdge = -19.6;
constexpr double kFurthest = 8;      // standard deviations about 0 that a range goes at most
constexpr double kFollowed = 5.9;    // standard deviations of v
constexpr double kGrowth = 0.4;      // of its width, by which a range grows at an end
constexpr double kClosest = 0.95;    // the greatest correlation that nodes are placed for
constexpr double kSmoothU = 0.33;    // in ln s: what likelihoods change within
constexpr double kMostNodesW = 512;  // where that would be less than all of them
// Nodes of a lattice that is read between its rows. Where it would have more, and more rows than there are nodes of w,
// its rows are those nodes, as always of choices: then it is laid out at every place, twice, for the derivatives.
constexpr std::size_t kMostToRead = 30'000;

// What a sum over equally spaced nodes makes of the variance of a normal density falls short of it by so much. Divided by
// the fourth power of a spread it is part of the slope of ln L by the spread's square: of a small one, where the answers
// tell no more than the prior, it would be the larger part.
// Source: Poisson's summation formula, as Trefethen and Weideman 2014, SIAM Review 56:385, section 5.
double lost_variance(double mean, double summed, double prior, double spacing, double offset) noexcept {
  constexpr double kLikePrior = 0.9;  // of its variance: what is narrower need not be a normal density
  if (summed < kLikePrior * prior * prior) return 0;
  const double turn = 2 * std::numbers::pi, phase = std::cos(turn * (mean / spacing - offset));
  const auto lost = [&](double variance) {
    const double nodes = turn * turn * variance / (spacing * spacing);
    return 2 * variance * nodes * std::exp(-nodes / 2) * phase;
  };
  return lost(summed + lost(summed));
}

}  // namespace

// The lattice nodes that the kernels of those nodes read.
LatticeRange HierarchicalLikelihood::Evaluation::read_by(std::size_t condition, const Rectangle& nodes) const noexcept {
  const LatticeKernel& s = over_s[condition];
  const int s0 = s.start(nodes.u0), s1 = s.start(nodes.u1) + static_cast<int>(s.taps()) - 1;
  if (rows_at_nodes[condition]) return {s0, s1, nodes.w0, nodes.w1};
  const LatticeKernel& k = over_k[condition];
  return {s0, s1, k.start(nodes.w0), k.start(nodes.w1) + static_cast<int>(k.taps()) - 1};
}

LatticeRows HierarchicalLikelihood::Evaluation::rows_of(std::size_t condition) const noexcept {
  const LatticeKernel& s = over_s[condition];
  return {s.starts(box.u0), s.weights(box.u0), s.taps(), wide, first_s[condition], high, read[condition].size() / high};
}

void HierarchicalLikelihood::Evaluation::lay_out_prior() {
  prior.resize(wide * high);
  const double spare = 1 - place.rho * place.rho;
  double scale = 1 / std::sqrt(spare);
  if (has_u) scale *= spacing_u / place.tu / std::sqrt(2 * std::numbers::pi);
  if (has_w) scale *= spacing_w / place.tw / std::sqrt(2 * std::numbers::pi);
  for (std::size_t j = 0; j < high; ++j) {
    const double b = has_w ? w(box.w0 + static_cast<int>(j)) / place.tw : 0;
    for (std::size_t i = 0; i < wide; ++i) {
      const double a = has_u ? u(box.u0 + static_cast<int>(i)) / place.tu : 0;
      prior[j * wide + i] = -(a * a - 2 * place.rho * a * b + b * b) / (2 * spare);
    }
  }
  exponentiate(prior, 0);
  for (double& one : prior) one *= scale;
}

void HierarchicalLikelihood::Evaluation::multiply() {
  joint = prior;
  for (const std::vector<double>& one : inner)
    for (std::size_t i = 0; i < joint.size(); ++i) joint[i] *= one[i];
  in_u.assign(wide, 0);
  in_w.assign(high, 0);
  total = 0;
  for (std::size_t j = 0; j < high; ++j)
    for (std::size_t i = 0; i < wide; ++i) {
      const double one = joint[j * wide + i];
      total += one;
      in_u[i] += std::abs(one);  // interpolation may fall below 0 where there is next to nothing
      in_w[j] += std::abs(one);
    }
}

HierarchicalLikelihood::Evaluation::Moments HierarchicalLikelihood::Evaluation::moments() const noexcept {
  Moments mean;
  std::vector<double> xs(wide), squares(wide);
  for (std::size_t i = 0; i < wide; ++i) {
    xs[i] = u(box.u0 + static_cast<int>(i));
    squares[i] = xs[i] * xs[i];
  }
  for (std::size_t j = 0; j < high; ++j) {
    const double* row = &joint[j * wide];
    const double y = w(box.w0 + static_cast<int>(j)), share = std::accumulate(row, row + wide, 0.0) / total,
                 x = dot(row, xs.data(), wide) / total;
    mean.u += x;
    mean.uu += dot(row, squares.data(), wide) / total;
    mean.w += share * y;
    mean.ww += share * y * y;
    mean.uw += x * y;
  }
  if (has_u) mean.uu += lost_variance(mean.u, mean.uu - mean.u * mean.u, place.tu, spacing_u, offset.u);
  if (has_w) mean.ww += lost_variance(mean.w, mean.ww - mean.w * mean.w, place.tw, spacing_w, offset.w);
  return mean;
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
    if (at.rows_at_nodes[c]) {
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
      if (at.rows_at_nodes[c]) {
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
      if (at.rows_at_nodes[c]) {
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
  at.rows_at_nodes.assign(conditions_, choice());
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
    if (!choice()) {
      at.over_k.emplace_back(place.kappa[c] + at.w(0), at.spacing_w, at.all.w0, at.all.w1, 0,
                             responses(c).steps().criterion, 0);
      const LatticeRange between = at.read_by(c, asked);
      at.rows_at_nodes[c] =
          between.nodes() > kMostToRead && between.high() > static_cast<std::size_t>(asked.w1 - asked.w0) + 1;
    }
    const LatticeRange needed = at.read_by(c, asked);
    if (at.rows_at_nodes[c]) {
      lay_out_rows(c, needed, place.kappa[c] + at.w(0), at.spacing_w);
      continue;
    }
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

// At the nodes of w, which are others at every place.
void HierarchicalLikelihood::lay_out_rows(std::size_t condition, const LatticeRange& needed, double origin,
                                          double spacing) {
  constexpr double kBeside = 1e-5;  // of a spread of choices; else of a step that could be read between
  Lattice& lattice = lattices_[condition].front();
  lattice.rows_at_nodes = true;
  LatticeSteps steps = lattice.responses.steps();
  if (steps.origin != origin || steps.criterion != spacing) {
    const double beside = kBeside * (choice() ? std::exp(needed.s0 * steps.ln_s) : steps.criterion);
    steps.origin = origin;
    steps.criterion = spacing;
    lattice.responses = ResponseLattice(model_, questions_[condition], shared_, steps);
    steps.origin += beside;
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

}  // namespace jnd
