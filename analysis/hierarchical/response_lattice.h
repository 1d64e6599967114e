// What answers are likely, on a lattice of spreads and criteria: once for each question of a study, and from these the
// log-likelihood of one participant's answers in one condition.
#pragma once

#include <compare>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "analysis/hierarchical/response_model.h"
#include "analysis/hierarchical/shared_parameters.h"

namespace jnd {

// Nodes first..last of both directions.
struct LatticeRange {
  int s0 = 0, s1 = -1, k0 = 0, k1 = -1;
  bool empty() const noexcept { return s1 < s0; }
  bool holds(const LatticeRange& other) const noexcept {
    return other.s0 >= s0 && other.s1 <= s1 && other.k0 >= k0 && other.k1 <= k1;
  }
  LatticeRange united(const LatticeRange& other) const noexcept;
  // What a table is built for that needs more than it has: both, unless most of that would lie idle; and a little more.
  LatticeRange covering(const LatticeRange& needed) const noexcept;
  LatticeRange widened(int by) const noexcept { return {s0 - by, s1 + by, k0 - by, k1 + by}; }
  std::size_t wide() const noexcept { return static_cast<std::size_t>(s1 - s0) + 1; }
  std::size_t high() const noexcept { return static_cast<std::size_t>(k1 - k0) + 1; }
  std::size_t nodes() const noexcept { return empty() ? 0 : wide() * high(); }
  // Of a node in an array that holds all spreads of the first criterion, then those of the next.
  std::size_t place(int s, int k) const noexcept {
    return static_cast<std::size_t>(k - k0) * wide() + static_cast<std::size_t>(s - s0);
  }
};

struct LatticeSteps {
  double ln_s = 0, criterion = 0;  // > 0
  double origin = 0;               // the criterion of node 0
};

// What was asked, as far as the answer's probability depends on it.
struct LatticeQuestion {
  double level = 0;
  bool second_half = false;  // of a person's trials in a condition
  friend bool operator==(const LatticeQuestion&, const LatticeQuestion&) = default;
  bool operator<(const LatticeQuestion& other) const noexcept {
    return level < other.level || (level == other.level && second_half < other.second_half);
  }
};

// Of one answer to one question, on the lattice.
struct AnswerTable {
  // How many of the guesses give this answer. 0: it is never given, and the rest is empty.
  double share = 0;
  std::vector<double> without_lapses, with_lapses;  // ln P; the second empty where there are none
  std::vector<double> rates;                        // P; empty where answers are not over-dispersed

  const std::vector<double>& log_rates() const noexcept { return with_lapses.empty() ? without_lapses : with_lapses; }
  // From what is without lapses to the others.
  void add_lapses(const SharedParameters& shared);
};
// Both answers; of the unsure ones, and of the sure, where there are such.
struct QuestionTables {
  AnswerTable positive, negative, sure_positive, sure_negative;
};

// What answers to every question are likely.
class ResponseLattice {
 public:
  ResponseLattice(ResponseModel model, std::vector<LatticeQuestion> questions, const SharedParameters& shared,
                  const LatticeSteps& steps);

  const LatticeSteps& steps() const noexcept { return steps_; }
  const LatticeRange& range() const noexcept { return range_; }
  void forget() noexcept { range_ = {}; }
  // Holds that range, and what it held before as far as that lies near it.
  void cover(const LatticeRange& range);
  // Holds that range beside what it held before.
  void extend(const LatticeRange& range);
  // Holds that range, with nothing to spare.
  void lay_out(const LatticeRange& range);
  const SharedParameters& shared() const noexcept { return shared_; }
  // From here on with these. Other lapses and over-dispersion cost little.
  void set_shared(const SharedParameters& shared);
  const QuestionTables& tables(std::size_t question) const noexcept { return tables_[question]; }
  // What was computed since this was last asked, about in nanoseconds.
  double worked() noexcept { return std::exchange(worked_, 0); }

 private:
  void lay_out_question(std::size_t i, const LatticeRange& before);

  ResponseModel model_;
  std::vector<LatticeQuestion> questions_;
  SharedParameters shared_;
  LatticeSteps steps_;
  LatticeRange range_;
  std::vector<QuestionTables> tables_;  // by question
  double worked_ = 0;
};

// The answers of one participant in one condition to one question.
struct QuestionAnswers {
  std::size_t question = 0;  // place in the questions
  AnswerTally counts;
};

// Their log-likelihood on the lattice, and its largest value there.
class CellLikelihood {
 public:
  explicit CellLikelihood(std::vector<QuestionAnswers> answers) : answers_(std::move(answers)) {}

  // How many numbers were added up.
  double cover(const LatticeRange& range, ResponseLattice& responses);
  // Exactly these nodes, and the derivatives by the criterion, from responses a step of it beside. As many.
  double take(const LatticeRange& range, const ResponseLattice& responses, const ResponseLattice& beside);
  const double* slope_at(int s, int k) const noexcept { return &slopes_[range_.place(s, k)]; }
  void forget() noexcept {
    range_ = {};
    values_ = {};
    slopes_ = {};
  }
  const LatticeRange& range() const noexcept { return range_; }
  const double* at(int s, int k) const noexcept { return &values_[range_.place(s, k)]; }
  double largest() const noexcept { return largest_; }
  const std::vector<QuestionAnswers>& answers() const noexcept { return answers_; }
  // The sum over these nodes, in the order of LatticeRange::place, of the weights times the log-likelihood by these
  // responses, or others beside them, which cover the nodes.
  double weighted_sum(const LatticeRange& nodes, const std::vector<double>& weights,
                      const ResponseLattice& responses) const;

 private:
  std::vector<QuestionAnswers> answers_;
  LatticeRange range_;
  SharedParameters shared_;  // of its values
  std::vector<double> values_, slopes_;
  double largest_ = 0;
};

}  // namespace jnd
