// QUEST: a threshold from the posterior over a grid of thresholds, after every answer.
//
// Watson & Pelli (1983), "QUEST: a Bayesian adaptive psychometric method", Perception & Psychophysics 33, 113-120, with
// the parameters of Pelli's later program (QuestCreate of the Psychophysics Toolbox). Levels x and thresholds T are on
// a logarithmic scale (log10 of the stimulus). The psychometric function is
//   psi(x; T) = delta gamma + (1 - delta) (1 - (1 - gamma) exp(-10^(beta (x - T + x0)))),
// with x0 such that psi(T; T) = p_threshold. The prior is Gaussian about t_guess. The posterior is a pure function of
// parameters and answers.
#pragma once

#include <string>
#include <vector>

namespace jnd {

struct QuestParameters {
  double t_guess = 0;         // log10 of the expected threshold, the middle of the grid
  double t_guess_sd = 1;      // > 0
  double p_threshold = 0.82;  // probability of a correct answer at threshold; within the range of psi
  double beta = 3.5;          // slope, > 0
  double delta = 0.01;        // share of answers given blindly, 0..1 (exclusive)
  double gamma = 0.5;         // probability of a correct answer without any stimulus, 0..1 (exclusive)
  double grain = 0.01;        // step of the grid, > 0
  double range = 5;           // of the grid: t_guess -/+ range / 2; > 0
};

// What is wrong with the parameters, in words; empty where they can be used.
std::string problem_of(const QuestParameters& parameters);

// x0 of the psychometric function above, from p_threshold in closed form.
double quest_threshold_shift(const QuestParameters& parameters);
// psi: probability of a correct answer at x where the threshold is t. shift: quest_threshold_shift(parameters).
double quest_probability(const QuestParameters& parameters, double shift, double x, double t);
// Thresholds t_guess + i grain with i = -n..n, n = ceil(range / grain / 2).
int quest_grid_size(const QuestParameters& parameters);

struct QuestEstimate {  // of the posterior
  double mean = 0, mode = 0;
  double median = 0;  // the first grid value with half below
  double sd = 0;
};

class Quest {
 public:
  // parameters: ones without a problem.
  explicit Quest(const QuestParameters& parameters);

  // The answer to a trial at level x, wherever that was.
  void answer(double x, bool correct);
  QuestEstimate estimate() const;
  int answers() const noexcept { return answers_; }

 private:
  QuestParameters parameters_;
  double shift_;
  std::vector<double> offsets_;    // of the thresholds from t_guess
  std::vector<double> posterior_;  // largest value 1
  int answers_ = 0;
};

}  // namespace jnd
