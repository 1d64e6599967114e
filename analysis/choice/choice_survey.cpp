#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "analysis/choice/choice_likelihood.h"

namespace jnd {

namespace {

constexpr double kSurveyLapse = 0.04;                                   // of a survey where the lapse is free
constexpr std::array<double, 5> kSurveySlopes = {1.5, 5, 15, 50, 200};  // of eta, over the range of the levels

// A place where the curve of one order may pass: eta there.
struct ChoiceAnchor {
  double t = 0, eta = 0;
  bool is_level = false;
};

// Between the levels at 1/2, and on each at its own rate; evenly thinned out where there are more than `most`.
std::vector<ChoiceAnchor> anchors_of(const ChoiceData& data, int order, double lapse, std::size_t most) {
  std::vector<ChoiceAnchor> all;
  double n = 0, k = 0;
  const auto finish_level = [&] {
    const double rate = std::clamp((k / n - 0.5 * lapse) / (1 - lapse), 0.02, 0.98);
    all.back().eta = choice_quantile(data.link, rate);
  };
  for (std::size_t i = 0; i < data.rows(); ++i) {
    if (order != 0 && data.o[i] != order) continue;
    if (all.empty() || all.back().t != data.t[i]) {
      if (!all.empty()) {
        finish_level();
        all.push_back({0.5 * (all.back().t + data.t[i]), 0, false});
      }
      all.push_back({data.t[i], 0, true});
      n = k = 0;
    }
    n += data.n[i];
    k += data.k[i];
  }
  if (!all.empty()) finish_level();
  if (all.size() <= most) return all;
  for (std::size_t i = 0; i < most; ++i) all[i] = all[i * (all.size() - 1) / (most - 1)];
  all.resize(most);
  return all;
}

// Peaks and the start of a climb from each.
class ChoiceSurvey {
 public:
  ChoiceSurvey(const ChoiceData& data, const ChoicePlace& start, const ChoiceBox& box, double pivot)
      : data_(data),
        start_(start),
        box_(box),
        pivot_(pivot),
        with_order_(!box.held(kB) || has_orders(data)),
        profiled_(box.held(kA) || box.held(kC) || (with_order_ && box.held(kB))) {
    if (!box.held(kL)) start_[kL] = kSurveyLapse;
    // A profile is looked at closely: its jumps lie where curves are steep.
    const std::size_t most = profiled_ ? 41 : 9;
    if (with_order_) {
      anchors_[0] = anchors_of(data, 1, start_[kL], most);
      anchors_[1] = anchors_of(data, -1, start_[kL], most);
    } else {
      anchors_[0] = anchors_of(data, 0, start_[kL], most);
    }
  }

  // The best of those that were seen, best first.
  std::vector<ChoicePeak> look() {
    if (box_.held(kC)) {
      look_at_slope(start_[kC]);
    } else {
      const double nearer = box_.held(kA) ? 1 / std::fmax(1, 2 * std::abs(pivot_)) : 1;
      for (const double slope : kSurveySlopes) look_at_slope(slope * nearer);
      // Far away the PSE may be the middle between a threshold among the levels and one beyond.
      if (with_order_ && nearer < 1)
        for (const double slope : kSurveySlopes) look_at_slope(slope);
      if (box_.held(kA) && !with_order_) look_through_anchors();
      if (with_order_ && (box_.held(kA) || box_.held(kB))) look_through_pairs();
    }
    const auto higher = [](const ChoicePeak& a, const ChoicePeak& b) { return a.value > b.value; };
    const std::size_t kept = std::min<std::size_t>(seen_.size(), profiled_ ? 6 : 4);
    std::partial_sort(seen_.begin(), seen_.begin() + static_cast<std::ptrdiff_t>(kept), seen_.end(), higher);
    seen_.resize(kept);
    return std::move(seen_);
  }

 private:
  static bool has_orders(const ChoiceData& data) noexcept {
    return std::any_of(data.o.begin(), data.o.end(), [](double o) { return o != 0; });
  }

  void see(const ChoicePlace& place) { seen_.push_back({place, choice_log_likelihood(data_, place, pivot_)}); }

  void look_at_slope(double c) {
    ChoicePlace place = start_;
    place[kC] = c;
    if (box_.held(kA)) {
      see(place);
      if (!with_order_ || box_.held(kB)) return;
      for (const int order : {1, -1})
        for (const ChoiceAnchor& at : anchors_[order < 0]) {
          place[kB] = order * (at.eta - c * (at.t - pivot_));
          see(place);
        }
      return;
    }
    if (!with_order_ || box_.held(kB)) {
      for (const int order : {1, -1})
        for (const ChoiceAnchor& at : anchors_[order < 0]) {
          place[kA] = at.eta - c * (at.t - pivot_) - (with_order_ ? order * place[kB] : 0);
          see(place);
        }
      return;
    }
    // Both free: the orders have curves of their own, each the same slope.
    for (const ChoiceAnchor& second : best_anchors(1, c))
      for (const ChoiceAnchor& first : best_anchors(-1, c)) {
        const double plus = second.eta - c * (second.t - pivot_), minus = first.eta - c * (first.t - pivot_);
        place[kA] = 0.5 * (plus + minus);
        place[kB] = 0.5 * (plus - minus);
        see(place);
      }
  }

  // The peaks among the anchors of one order at slope c, up to three.
  std::vector<ChoiceAnchor> best_anchors(int order, double c) const {
    const std::vector<ChoiceAnchor>& all = anchors_[order < 0];
    std::vector<double> values;
    for (const ChoiceAnchor& at : all) values.push_back(value_of_order(order, at, c));
    std::vector<std::size_t> peaks;
    for (std::size_t i = 0; i < all.size(); ++i)
      if ((i == 0 || values[i - 1] <= values[i]) && (i + 1 == all.size() || values[i + 1] <= values[i]))
        peaks.push_back(i);
    std::sort(peaks.begin(), peaks.end(), [&](std::size_t a, std::size_t b) { return values[a] > values[b]; });
    std::vector<ChoiceAnchor> best;
    for (std::size_t i = 0; i < std::min<std::size_t>(peaks.size(), 3); ++i) best.push_back(all[peaks[i]]);
    return best;
  }

  double value_of_order(int order, const ChoiceAnchor& at, double c) const noexcept {
    double sum = 0;
    const double l = start_[kL];
    for (std::size_t i = 0; i < data_.rows(); ++i) {
      if (data_.o[i] != order) continue;
      const double f = choice_cdf(data_.link, at.eta + c * (data_.t[i] - at.t));
      sum += choice_count_log(data_.k[i], 0.5 * l + (1 - l) * f) +
             choice_count_log(data_.n[i] - data_.k[i], 0.5 * l + (1 - l) * (1 - f));
    }
    return sum;
  }

  // With the PSE held a level at its rate says the slope.
  void look_through_anchors() {
    ChoicePlace place = start_;
    for (const ChoiceAnchor& at : anchors_[0]) {
      place[kC] = at.eta / (at.t - pivot_);
      if (place[kC] > 0 && place[kC] < kSteepestChoice) see(place);
    }
  }

  // With the PSE or b held two levels, one of each order, say the slope and the other.
  void look_through_pairs() {
    ChoicePlace place = start_;
    for (const ChoiceAnchor& second : anchors_[0])
      for (const ChoiceAnchor& first : anchors_[1]) {
        if (!second.is_level && !first.is_level && box_.held(kA)) continue;
        const double x_second = second.t - pivot_, x_first = first.t - pivot_;
        if (box_.held(kA) && box_.held(kB)) continue;
        if (box_.held(kA)) {
          place[kC] = (second.eta + first.eta) / (x_second + x_first);
          place[kB] = second.eta - place[kC] * x_second;
        } else {
          place[kC] = (second.eta - first.eta - 2 * place[kB]) / (x_second - x_first);
          place[kA] = second.eta - place[kB] - place[kC] * x_second;
        }
        if (place[kC] > 0 && place[kC] < kSteepestChoice) see(place);
      }
  }

  const ChoiceData& data_;
  ChoicePlace start_;
  const ChoiceBox& box_;
  double pivot_;
  bool with_order_, profiled_;
  std::array<std::vector<ChoiceAnchor>, 2> anchors_;  // of o = 1 (or of all), and of o = -1
  std::vector<ChoicePeak> seen_;
};

}  // namespace

ChoicePeak climb_from_survey(const ChoiceData& data, const ChoicePlace& start, const ChoiceBox& box, double pivot) {
  ChoicePeak best = climb(data, start, box, pivot);
  ChoiceSurvey survey(data, start, box, pivot);
  for (const ChoicePeak& from : survey.look()) {
    const ChoicePeak found = climb(data, from.place, box, pivot);
    if (found.value > best.value) best = found;
  }
  return best;
}

ChoicePeak climb_from_best(const ChoiceData& data, const ChoicePlace& start, const ChoiceBox& box, double pivot) {
  ChoicePeak from{start, choice_log_likelihood(data, start, pivot)};
  ChoiceSurvey survey(data, start, box, pivot);
  const std::vector<ChoicePeak> seen = survey.look();
  if (!seen.empty() && seen.front().value > from.value) from = seen.front();
  return climb(data, from.place, box, pivot);
}

}  // namespace jnd
