#include "analysis/choice/choice_likelihood.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "analysis/numerics/normal.h"

namespace jnd {

namespace {

void check_choice_row(const ChoiceRow& row, bool with_order) {
  if (!std::isfinite(row.level)) throw std::invalid_argument("a level is not a finite number");
  if (row.n < 0 || row.chosen < 0 || row.chosen > row.n)
    throw std::invalid_argument("chosen must lie in 0..n, not " + std::to_string(row.chosen) + " of " +
                                std::to_string(row.n));
  if (with_order && row.order != 1 && row.order != -1)
    throw std::invalid_argument("the order must be 1 (comparison second) or -1 (first), not " +
                                std::to_string(row.order));
}

// F, 1 - F and the density at eta. Far out the smaller of the two underflows to 0; see below.
struct LinkPoint {
  double p, q, density, density_slope;
};

LinkPoint link_point(ChoiceLink link, double eta) noexcept {
  const double distance = std::abs(eta);
  double tail = 0, density = 0, density_slope = 0;
  if (link == ChoiceLink::probit) {
    tail = normal_cdf(-distance);
    density = normal_density(distance);
    density_slope = -eta * density;
  } else {
    const double e = std::exp(-distance);
    tail = e / (1 + e);
    density = tail / (1 + e);
    density_slope = eta > 0 ? -density * (1 - 2 * tail) : density * (1 - 2 * tail);
  }
  if (eta < 0) return {tail, 1 - tail, density, density_slope};
  return {1 - tail, tail, density, density_slope};
}

constexpr double kFarOut = 25;  // |eta| from which answers in the tail are taken by their logarithms

// One kind of answer whose probability is F(side * eta), without lapses: ln F and its derivatives on eta.
struct TailTerm {
  double log_p, first, second;
};

TailTerm tail_term(ChoiceLink link, double side, double eta) noexcept {
  const double u = side * eta;
  if (link == ChoiceLink::probit) {
    const LogNormalCdf tail = log_normal_cdf(u);
    const double mills = tail.inverse_mills;
    return {tail.log_cdf, side * mills, std::fmin(0, -mills * (u + mills))};
  }
  const double e = std::exp(-std::abs(u)), other = u > 0 ? e / (1 + e) : 1 / (1 + e);  // 1 - F(u)
  return {(u > 0 ? 0 : u) - std::log1p(e), side * other, -e / ((1 + e) * (1 + e))};
}

struct ChoiceSlope {
  double value = 0;
  ChoicePlace gradient{};
  std::array<ChoicePlace, kChoiceVariables> information{};  // minus the second derivatives; lower triangle
};

// Derivatives of one row on eta and l.
struct RowSlope {
  double value = 0, eta = 0, l = 0, eta_eta = 0, eta_l = 0, l_l = 0;
};

RowSlope far_row(ChoiceLink link, double eta, double k, double rest) noexcept {
  RowSlope row;
  for (const auto& [count, side] : {std::pair(k, 1.0), std::pair(rest, -1.0)}) {
    if (count == 0) continue;
    const TailTerm term = tail_term(link, side, eta);
    row.value += count * term.log_p;
    row.eta += count * term.first;
    row.eta_eta += count * term.second;
  }
  return row;
}

enum class ChoiceCurvature { observed, expected };  // second derivatives, or minus the Fisher information

template <ChoiceCurvature curvature>
RowSlope row_slope(ChoiceLink link, double eta, double l, double n, double k) noexcept {
  const double rest = n - k;
  if (l == 0 && std::abs(eta) > kFarOut) return far_row(link, eta, k, rest);
  const LinkPoint at = link_point(link, eta);
  const double keep = 1 - l, p = 0.5 * l + keep * at.p, q = 0.5 * l + keep * at.q;
  const double by_p = k / p, by_q = rest / q, g = by_p - by_q, w = by_p / p + by_q / q;
  const double p_eta = keep * at.density, p_l = 0.5 - at.p;
  RowSlope row;
  row.value = (k > 0 ? k * std::log(p) : 0) + (rest > 0 ? rest * std::log(q) : 0);
  row.eta = g * p_eta;
  row.l = g * p_l;
  if constexpr (curvature == ChoiceCurvature::observed) {
    row.eta_eta = g * keep * at.density_slope - w * p_eta * p_eta;
    row.eta_l = -g * at.density - w * p_eta * p_l;
    row.l_l = -w * p_l * p_l;
  } else {
    const double fisher = n / (p * q);
    row.eta_eta = -fisher * p_eta * p_eta;
    row.eta_l = -fisher * p_eta * p_l;
    row.l_l = -fisher * p_l * p_l;
  }
  return row;
}

template <ChoiceCurvature curvature = ChoiceCurvature::observed>
ChoiceSlope choice_slope(const ChoiceData& data, const ChoicePlace& place, double pivot) noexcept {
  ChoiceSlope sum;
  for (std::size_t i = 0; i < data.rows(); ++i) {
    const double x = data.t[i] - pivot, o = data.o[i];
    const RowSlope row =
        row_slope<curvature>(data.link, place[kA] + place[kC] * x + place[kB] * o, place[kL], data.n[i], data.k[i]);
    sum.value += row.value;
    const std::array<double, 3> design = {1, x, o};
    for (std::size_t j = 0; j < 3; ++j) {
      sum.gradient[j] += row.eta * design[j];
      for (std::size_t m = 0; m <= j; ++m) {
        sum.information[j][m] -= row.eta_eta * design[j] * design[m];
      }
      sum.information[kL][j] -= row.eta_l * design[j];
    }
    sum.gradient[kL] += row.l;
    sum.information[kL][kL] -= row.l_l;
  }
  return sum;
}

using Triangle = std::array<ChoicePlace, kChoiceVariables>;

// Solves matrix * step = gradient over the free variables; false where it is not positive definite.
bool solve_choice_step(const Triangle& matrix, const ChoicePlace& gradient,
                       const std::array<bool, kChoiceVariables>& held, double damping, ChoicePlace& step) noexcept {
  std::array<std::size_t, kChoiceVariables> free{};
  std::size_t m = 0;
  for (std::size_t i = 0; i < kChoiceVariables; ++i)
    if (!held[i]) free[m++] = i;
  Triangle factor{};
  ChoicePlace x{};
  for (std::size_t i = 0; i < m; ++i) {
    x[i] = gradient[free[i]];
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = matrix[free[i]][free[j]];
      if (i == j) sum += damping * std::abs(sum);
      const double least = 1e-13 * std::abs(sum);
      for (std::size_t k = 0; k < j; ++k) sum -= factor[i][k] * factor[j][k];
      if (i == j) {
        if (!(sum > least) || !std::isfinite(sum)) return false;
        factor[i][i] = std::sqrt(sum);
      } else {
        factor[i][j] = sum / factor[j][j];
      }
    }
    for (std::size_t k = 0; k < i; ++k) x[i] -= factor[i][k] * x[k];
    x[i] /= factor[i][i];
  }
  for (std::size_t i = m; i-- > 0;) {
    for (std::size_t k = i + 1; k < m; ++k) x[i] -= factor[k][i] * x[k];
    x[i] /= factor[i][i];
  }
  step = {};
  for (std::size_t i = 0; i < m; ++i) {
    if (!std::isfinite(x[i])) return false;
    step[free[i]] = x[i];
  }
  return true;
}

// A step uphill that does not leave the box at once; false where none is left.
bool choice_step(const ChoiceData& data, const ChoiceSlope& at, const ChoicePlace& place, double pivot,
                 const ChoiceBox& box, ChoicePlace& step) noexcept {
  std::array<bool, kChoiceVariables> held{};
  for (std::size_t i = 0; i < kChoiceVariables; ++i)
    held[i] = box.held(i) || (place[i] <= box.lower[i] && at.gradient[i] <= 0) ||
              (place[i] >= box.upper[i] && at.gradient[i] >= 0);
  for (;;) {
    if (held[kA] && held[kC] && held[kB] && held[kL]) return false;
    bool solved = solve_choice_step(at.information, at.gradient, held, 0, step);
    if (!solved) {
      const ChoiceSlope expected = choice_slope<ChoiceCurvature::expected>(data, place, pivot);
      // NOLINTNEXTLINE(cert-flp30-c)
      for (double damping = 1e-9; !solved && damping < 1e3; damping *= 1000)
        solved = solve_choice_step(expected.information, at.gradient, held, damping, step);
    }
    if (!solved) return false;
    bool outward = false;
    for (std::size_t i = 0; i < kChoiceVariables; ++i) {
      if (held[i] || ((place[i] > box.lower[i] || step[i] >= 0) && (place[i] < box.upper[i] || step[i] <= 0))) continue;
      held[i] = outward = true;
    }
    if (!outward) return true;
  }
}

// In the tails the logistic function is so straight that a step would go much too far: no eta by more than a few times
// the largest there is.
void shorten(const ChoiceData& data, const ChoicePlace& place, double pivot, ChoicePlace& step) noexcept {
  double largest = 0, change = 0;
  for (std::size_t i = 0; i < data.rows(); ++i) {
    const double x = data.t[i] - pivot, o = data.o[i];
    largest = std::fmax(largest, std::abs(place[kA] + place[kC] * x + place[kB] * o));
    change = std::fmax(change, std::abs(step[kA] + step[kC] * x + step[kB] * o));
  }
  const double most = 4 + 3 * largest;
  if (!(change > most)) return;
  for (double& part : step) part *= most / change;
}

// How much of the step stays in the box, and which bound stops it (kChoiceVariables: none).
std::pair<double, std::size_t> room_for(const ChoicePlace& place, const ChoicePlace& step,
                                        const ChoiceBox& box) noexcept {
  double longest = 1;
  std::size_t blocking = kChoiceVariables;
  for (std::size_t i = 0; i < kChoiceVariables; ++i) {
    if (step[i] == 0) continue;
    const double room = ((step[i] > 0 ? box.upper[i] : box.lower[i]) - place[i]) / step[i];
    if (room >= longest) continue;
    longest = room;
    blocking = i;
  }
  return {longest, blocking};
}

constexpr double kOpen = 1e300;  // a bound that is none

}  // namespace

double choice_count_log(double e, double p) noexcept {
  return e > 0 ? e * std::log(p) : 0.0;
}

double choice_cdf(ChoiceLink link, double eta) noexcept {
  if (link == ChoiceLink::probit) return normal_cdf(eta);
  return 1 / (1 + std::exp(-eta));
}

double choice_quantile(ChoiceLink link, double p) noexcept {
  if (link == ChoiceLink::probit) return normal_quantile(p);
  return std::log(p) - std::log1p(-p);
}

ChoiceData choice_data(std::span<const ChoiceRow> rows, ChoiceLink link, bool with_order) {
  ChoiceData data;
  data.link = link;
  std::vector<const ChoiceRow*> used;
  used.reserve(rows.size());
  for (const ChoiceRow& row : rows) {
    check_choice_row(row, with_order);
    if (row.n > 0) used.push_back(&row);
  }
  if (used.empty()) return data;
  const auto by_level = [](const ChoiceRow* a, const ChoiceRow* b) { return a->level < b->level; };
  if (!std::is_sorted(used.begin(), used.end(), by_level)) std::stable_sort(used.begin(), used.end(), by_level);
  const double low = used.front()->level, high = used.back()->level;
  data.shift = low + 0.5 * (high - low);
  if (high > low) data.scale = high - low;
  for (auto* column : {&data.t, &data.o, &data.n, &data.k, &data.level}) column->reserve(used.size());
  for (const ChoiceRow* row : used) {
    const double n = static_cast<double>(row->n), k = static_cast<double>(row->chosen);
    data.level.push_back(row->level);
    data.t.push_back((row->level - data.shift) / data.scale);
    data.o.push_back(with_order ? row->order : 0);
    data.n.push_back(n);
    data.k.push_back(k);
    data.trials += n;
    data.chosen += k;
    data.saturated += choice_count_log(k, k / n) + choice_count_log(n - k, (n - k) / n);
  }
  return data;
}

ChoiceBox choice_box(bool with_order, const std::optional<double>& lapse) noexcept {
  ChoiceBox box{{-kOpen, 0, -kOpen, 0}, {kOpen, kSteepestChoice, kOpen, kLargestChoiceLapse}};
  if (!with_order) box.hold(kB, 0);
  if (lapse) box.hold(kL, *lapse);
  return box;
}

double choice_log_likelihood(const ChoiceData& data, const ChoicePlace& place, double pivot) noexcept {
  const double l = place[kL], keep = 1 - l;
  double sum = 0;
  for (std::size_t i = 0; i < data.rows(); ++i) {
    const double eta = place[kA] + place[kC] * (data.t[i] - pivot) + place[kB] * data.o[i];
    const double k = data.k[i], rest = data.n[i] - k;
    if (l == 0 && std::abs(eta) > kFarOut) {
      if (k > 0) sum += k * tail_term(data.link, 1, eta).log_p;
      if (rest > 0) sum += rest * tail_term(data.link, -1, eta).log_p;
      continue;
    }
    double tail = 0;
    if (data.link == ChoiceLink::probit) {
      tail = normal_cdf(-std::abs(eta));
    } else {
      const double e = std::exp(-std::abs(eta));
      tail = e / (1 + e);
    }
    const double p = 0.5 * l + keep * (eta < 0 ? tail : 1 - tail), q = 0.5 * l + keep * (eta < 0 ? 1 - tail : tail);
    if (k > 0) sum += k * std::log(p);
    if (rest > 0) sum += rest * std::log(q);
  }
  return sum;
}

ChoicePeak climb(const ChoiceData& data, const ChoicePlace& start, const ChoiceBox& box, double pivot) noexcept {
  constexpr int kMostSteps = 200, kMostHalvings = 40;
  constexpr double kNegligible = 1e-11, kQuadratic = 1e-9, kRounding = 1e-13;
  ChoicePeak peak{start, -kInf};
  ChoiceSlope at = choice_slope(data, start, pivot);
  ChoicePlace step{};
  for (int steps = 0; steps < kMostSteps; ++steps) {
    peak.value = at.value;
    if (!choice_step(data, at, peak.place, pivot, box, step)) return peak;
    shorten(data, peak.place, pivot, step);
    double ascent = 0;
    for (std::size_t i = 0; i < kChoiceVariables; ++i) ascent += at.gradient[i] * step[i];
    const auto [longest, blocking] = room_for(peak.place, step, box);
    const double near_top = kQuadratic + kRounding * std::abs(at.value);  // where rounding hides the gain
    double part = longest;
    bool moved = false;
    if (!(ascent > 0)) return peak;
    // NOLINTNEXTLINE(cert-flp30-c)
    for (int halving = 0; halving < kMostHalvings && !moved; ++halving, part /= 2) {
      ChoicePlace trial = peak.place;
      for (std::size_t i = 0; i < kChoiceVariables; ++i) trial[i] += part * step[i];
      if (blocking != kChoiceVariables && halving == 0)
        trial[blocking] = step[blocking] > 0 ? box.upper[blocking] : box.lower[blocking];
      // So close to the top that the quadratic model is exact, and its step the last one.
      if (ascent < kNegligible && blocking == kChoiceVariables) return {trial, at.value + 0.5 * ascent};
      ChoiceSlope next = choice_slope(data, trial, pivot);
      moved = next.value >= at.value + 1e-4 * part * ascent || (ascent < near_top && std::isfinite(next.value));
      if (!moved) continue;
      peak.place = trial;
      at = next;
    }
    if (!moved) return peak;
  }
  peak.value = at.value;
  return peak;
}

ChoicePlace choice_start(const ChoiceData& data, const ChoiceBox& box) noexcept {
  const double to_link = data.link == ChoiceLink::probit ? 0.6 : 1.0;
  double w = 0, wt = 0, wz = 0, wtt = 0, wtz = 0, wo = 0, woz = 0;
  for (std::size_t i = 0; i < data.rows(); ++i) {
    const double k = data.k[i] + 0.5, rest = data.n[i] - data.k[i] + 0.5;
    const double weight = k * rest / (k + rest), z = to_link * std::log(k / rest);
    w += weight;
    wt += weight * data.t[i];
    wz += weight * z;
    wtt += weight * data.t[i] * data.t[i];
    wtz += weight * data.t[i] * z;
    wo += weight * data.o[i];
    woz += weight * data.o[i] * z;
  }
  const double spread = wtt - wt * wt / w;
  ChoicePlace start{};
  start[kC] = spread > 0 ? std::fmax(0, (wtz - wt * wz / w) / spread) : 0;
  start[kA] = (wz - start[kC] * wt) / w;
  start[kB] = (woz - start[kA] * wo) / w;
  start[kL] = 0.02;
  for (std::size_t i = 0; i < kChoiceVariables; ++i) start[i] = std::clamp(start[i], box.lower[i], box.upper[i]);
  return start;
}

}  // namespace jnd
