// The largest ln L where one number of the model is held, and the 95 % interval that follows.
//
// Every value is searched from its nearest neighbour, the first from the free maximum; a test, and each end of an interval,
// from other spreads too. An end at which these find more than the first search did is left behind, and the search
// goes on outwards. An interval is the connected set of values about the estimate.
//
// Source: Venzon and Moolgavkar 1988, Appl Statist 37:87.
#pragma once

#include <functional>
#include <vector>

#include "analysis/hierarchical/hierarchical_search.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"

namespace jnd {

enum class EndsStatus {
  ok,
  not_computed,
  not_converged,  // an end could not be confirmed
  by_curvature,   // searches would have taken too long (HierarchicalAnalysis): from the observed information instead
  out_of_work     // and that told nothing: the interval is unknown
};
inline constexpr auto kEndsStatusWords = words<EndsStatus>({{"ok", EndsStatus::ok},
                                                            {"not_computed", EndsStatus::not_computed},
                                                            {"not_converged", EndsStatus::not_converged},
                                                            {"by_curvature", EndsStatus::by_curvature},
                                                            {"out_of_work", EndsStatus::out_of_work}});

// 95 % by profile likelihood, the other parameters at their best; an end that the answers leave open is infinite. NaN
// unless ok or by_curvature.
struct ProfileEnds {
  double low = kNaN, high = kNaN;
  EndsStatus status = EndsStatus::not_computed;
};

// A search with the number held: what it is of, and where it begins from a maximum with another value.
struct HeldSearch {
  HierarchicalForm form;
  HierarchicalMaximum start;
};
struct HeldNumber {
  double estimate = 0;
  double lowest = -kInf, highest = kInf;      // the furthest values that are looked at
  double open_low = -kInf, open_high = kInf;  // what an end is where ln L does not fall so far
  double unit = 1;                            // a first look is a third of it away
  std::function<HeldSearch(double value, const HierarchicalMaximum& from)> hold;
  std::function<double(HierarchicalLikelihood&, const HierarchicalMaximum&)> slope;  // of ln L by the number
};

// A maximum with something held lies above the free one, which is none then.
struct BetterMaximum {
  HierarchicalMaximum maximum;
};
inline constexpr double kTold = 1e-6;  // of ln L: by so much maxima are told apart

class Profile {
 public:
  Profile(HierarchicalSearch& search, const HierarchicalMaximum& best, const HeldNumber& number);

  // How far the largest ln L with the number at that value lies below the free maximum, from all starts; >= 0, and not a
  // number where the work is used up. Throws BetterMaximum.
  double drop(double value, double most_work = kInf);
  // Values whose drop was asked for are points of it. Throws BetterMaximum.
  ProfileEnds ends(double most_work = kInf);

 private:
  struct Point {
    double value = 0, drop = 0;
    HierarchicalMaximum maximum;
    bool confirmed = false;  // from all starts
  };
  HierarchicalMaximum searched(double value, const HierarchicalMaximum& from) const;
  const Point& look(double value);
  const Point& confirm(double value);
  const Point& keep(double value, HierarchicalMaximum maximum);
  const Point& nearest(double value) const;
  bool worked() const noexcept { return search_.work() > most_work_; }
  double end(double side, EndsStatus& status);
  double crossing(double inside, double outside, double first);

  HierarchicalSearch& search_;
  const HierarchicalMaximum& best_;
  const HeldNumber& number_;
  double most_work_ = kInf;    // of the search
  std::vector<Point> points_;  // by value; one of them is the estimate
};

// Other places to search from: spreads small and large.
std::vector<HierarchicalMaximum> with_other_spreads(const HierarchicalForm& form, const HierarchicalMaximum& from,
                                                    double criterion_unit);

}  // namespace jnd
