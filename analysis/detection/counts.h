// The four numbers of a same-different cell, and the rates and corrections that turn them into z scores.
#pragma once

#include <optional>
#include <string_view>

namespace jnd {

struct Counts {
  int n_diff = 0;        // trials with different stimuli
  int hits = 0;          // of them answered "different"; 0..n_diff
  int n_same = 0;        // trials with equal stimuli
  int false_alarms = 0;  // of them answered "different"; 0..n_same
  int trials() const noexcept { return n_diff + n_same; }
  // One trial: whether its stimuli were equal, and what was said of them.
  void add(bool same, bool said_different) noexcept {
    ++(same ? n_same : n_diff);
    if (said_different) ++(same ? false_alarms : hits);
  }
  Counts& operator+=(const Counts& other) noexcept {
    n_diff += other.n_diff;
    hits += other.hits;
    n_same += other.n_same;
    false_alarms += other.false_alarms;
    return *this;
  }
  bool operator==(const Counts&) const = default;
};

// What is done about rates of 0 and 1, whose z is infinite.
//   none       the raw rate
//   loglinear  (k + 0.5) / (n + 1), always applied (Hautus 1995, Behav Res Meth 27:46)
//   half       only 0 -> 1/(2n) and 1 -> 1 - 1/(2n) (Macmillan and Kaplan 1985, Psychol Bull 98:185)
enum class Correction { none, loglinear, half };

std::string_view to_string(Correction correction) noexcept;
std::optional<Correction> correction_from(std::string_view name) noexcept;

// k of n, n >= 1. In 0..1.
double corrected_rate(int k, int n, Correction correction) noexcept;

}  // namespace jnd
