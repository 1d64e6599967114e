// The Bayesian adaptive procedure: after every answer the posterior over a grid of observers, and as the next level the
// one whose answer is expected to teach most.
//
// Kontsevich and Tyler 1999, "Bayesian adaptive estimation of psychometric slope and threshold", Vision Research 39,
// 2729-2737 (entropy); the expected variance of the quantity that the study is about instead, as in King-Smith et al.
// 1994, Vision Research 34, 885-912. An observer is (ln s, shift, lapse), and says "different", or chooses the
// comparison, with probability
//   same-different  lapse/2 + (1 - lapse) Phi(dK/s - k)            shift: k, the criterion in units of s; JND = s
//   which           lapse/2 + (1 - lapse) Phi((x - standard - a)/s)  shift: a, the PSE's distance from the standard
// held within 1e-9 and 1 - 1e-9. The prior is a Gaussian of ln s times a Gaussian of the shift times weights of the
// lapses. The procedure is a pure function of its configuration and the answers: replaying them gives the same levels,
// on every machine as far as its Phi has the same bits (sums have one order; ties within 1e-12 go to the first level).
//
// Accuracy: 1e-12. Tests: sequences of an independent implementation in numpy and R, levels exactly, the rest 1e-10.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace jnd {

enum class PosteriorTask { same_different, which };

// What a level is chosen for.
enum class PosteriorUtility {
  variance,  // a small expected variance of ln s
  entropy    // much mutual information of the answer and the whole observer, in nats
};

// Of a Gaussian.
struct PosteriorPrior {
  double mean = 0, sd = 1;  // sd > 0
};

struct PosteriorConfiguration {
  PosteriorTask task = PosteriorTask::same_different;
  PosteriorUtility utility = PosteriorUtility::variance;
  double standard = 0;  // of `which`, in the unit of the levels; same-different has differences, and no use for it
  // same-different: differences, the first of them 0 (a same trial), the others above 0. which: the comparisons.
  std::vector<double> levels;
  std::vector<double> ln_s, shift, lapse;  // the grid; lapse 0..1 (exclusive)
  PosteriorPrior ln_s_prior, shift_prior;
  std::vector<double> lapse_weights;  // >= 0, one of them above 0; as many as lapses
};

// The most of levels x observers: the tables of a configuration stay below 200 MB.
inline constexpr std::size_t kMostPosteriorCells = 10'000'000;

// What is wrong with a configuration, in words; empty where it can be used.
std::string problem_of(const PosteriorConfiguration& configuration);

// What a trial may present. t: trials so far; n: of them same trials; b: of them with a comparison below the standard.
enum class PosteriorSlot {
  free,       // which: every level. same-different: no same trial where n + 1 > ceil((t+1)/2), nothing but one where
              // n < floor((t+1)/3)
  same,       // same-different: the first level
  different,  // same-different: every level but the first
  below,      // which: levels below the standard
  above,      // which: levels above it
  balanced    // which: above where 2 b > t + 1, below where 2 b < t - 1, else every level
};
// "S", "D", "F" of same-different, "F", "L", "U", "B" of which; none for other letters.
std::optional<PosteriorSlot> posterior_slot_from(char letter, PosteriorTask task) noexcept;

// Of the posterior.
struct PosteriorEstimate {
  double mean_ln_s = 0, sd_ln_s = 0;
  double mean_shift = 0, sd_shift = 0;
  double mean_lapse = 0, sd_lapse = 0;
};

struct PosteriorChoice {
  std::size_t level = 0;  // its place among the levels
  // same-different, variance: minus the expected posterior variance of ln s; which: its expected reduction. NaN in a
  // slot `same`, where nothing is chosen.
  double utility = 0;
};

// Copies go their own ways. Thread rule: one thread. Nothing is allocated after the constructor.
class PosteriorProcedure {
 public:
  // configuration: one without a problem.
  explicit PosteriorProcedure(const PosteriorConfiguration& configuration);

  // The level to present next. Asked again without an answer it is the same. slot: one of the task, with a level in it.
  PosteriorChoice choose(PosteriorSlot slot) noexcept;
  // The answer to a trial at a level (its place), wherever that came from. positive: "different", or the comparison
  // was chosen.
  void update(std::size_t level, bool positive) noexcept;

  PosteriorEstimate estimate() const noexcept;
  // The 100 share % point of ln s, 0 < share < 1: the grid's masses spread evenly between the midpoints of its nodes.
  // Always finite. The grid must be ascending in ln s.
  double ln_s_quantile(double share) const noexcept;
  // The mass of each ln s of the grid, in its order; sums to 1.
  void ln_s_masses(std::vector<double>& masses) const;

  double level(std::size_t place) const noexcept { return levels_[place]; }
  std::size_t levels() const noexcept { return levels_.size(); }
  int trials() const noexcept { return trials_; }

 private:
  double utility_of(std::size_t level) const noexcept;
  std::size_t row_size() const noexcept { return shift_.size() * lapse_.size(); }
  double row_mass(std::size_t row) const noexcept;
  bool allowed(std::size_t level, PosteriorSlot slot) const noexcept;
  PosteriorSlot narrowed(PosteriorSlot slot) const noexcept;
  void remember_moments() noexcept;

  PosteriorTask task_;
  PosteriorUtility utility_;
  double standard_;
  std::vector<double> levels_, ln_s_, shift_, lapse_;
  std::vector<double> centred_;        // ln s less the middle of the grid: sums of squares keep their digits
  std::vector<double> probabilities_;  // levels x observers; observers: ln s, then shift, then lapse
  std::vector<double> entropies_;      // of the probabilities; only where the utility is entropy
  std::vector<double> posterior_;      // of the observers; sums to 1
  std::vector<double> utilities_;      // of the levels: room for choose()
  double first_ = 0, second_ = 0;      // moments of centred_ over the posterior
  int trials_ = 0, same_ = 0, below_ = 0;
};

// The grid and the prior that the Bayesian procedure has where a study gives none.
// For a standard of 900 N/m they are, with differences in N/m,
//   same-different  ln s: 31 values, 60 to 1200; k: 17 values, -0.5 to 2.5; lapse 0, 0.025, 0.05. Prior: ln s about ln 275,
//                   SD 0.7; k about 0.75, SD 0.75; lapses as 5 : 3 : 2
//   which           ln s: 30 values, 40 to 800; a: 13 values, -120 to 120; lapse 0, 0.02, 0.06. Prior: ln s about ln 180,
//                   SD 0.8; a about 0, SD 60; lapses as 10 : 7 : 3
// and what has a unit grows in proportion to the standard (Weber's law). standard: above 0. Without levels and utility; of
// which with the standard.
PosteriorConfiguration default_posterior(PosteriorTask task, double standard);

}  // namespace jnd
