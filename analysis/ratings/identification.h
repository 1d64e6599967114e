// Identification: one of N stimuli a trial, named by one of N responses. From the confusion matrix: the information that
// responses transmit, and d' between neighbours.
//
//   I = sum p_ij log2(p_ij / (p_i p_j)), 0 log 0 = 0, bits of the counts as they are (biased upwards)
//   jackknife:        N I - (N - 1) times the mean information without one trial
//                       = sum p_ij (d(n_ij) - d(n_i) - d(n_j) + d(N)), d(x) = x log2 x - (x - 1) log2(x - 1)
//   Miller-Madow:     I + ((K_S - 1) + (K_R - 1) - (K_SR - 1)) / (2 N ln 2), K: rows, columns, cells that are not empty
//   table corrected:  I - (K_S - 1)(K_R - 1) / (2 N ln 2)
//   equivalent classes 2^I: so many could be told apart without error; relative: I / entropy of the stimuli
// The corrections differ, and none is cut off at 0. Miller-Madow counts only cells that are not empty and leaves much of
// the bias; the correction by the table takes off too much if most errors are between neighbours.
//
//   adjacent, log-linear: z of the share of responses above i after stimulus i + 1, less that after stimulus i, both
//     (k + 0.5)/(n + 1)
//   adjacent, maximum likelihood: P(response <= j | i) = Phi(c_j - mu_i) with criteria common to all stimuli and mu of the
//     first 0 (Thurstone); d' = mu_(i+1) - mu_i with errors from the observed information. Responses that were never
//     given are left out.
//
// Source: Zahl 1977, Ecology 58:907; Miller 1955, Note on the bias of information estimates; Miller and Madow 1954;
// Braida and Durlach 1972, J Acoust Soc Am 51:483 (d' and total d'); Macmillan and Creelman 2005, chapter 5. Checked
// against: R 4.2.2 (ordinal::clm), bits 1e-12, d' 1e-6.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace jnd {

enum class IdentificationStatus {
  ok,
  separated,       // the stimuli fall into groups that no response mixes: d' between groups is infinite
  single_class,    // one stimulus only: there is nothing to tell it from
  no_information,  // one and the same response throughout
  missing          // no trial
};
std::string_view to_string(IdentificationStatus status) noexcept;

struct AdjacentDprime {
  double dprime,
      se;  // d' +-inf between groups; NaN where a stimulus was never presented, se NaN with it or at infinity
};

struct IdentificationScale {
  IdentificationStatus status = IdentificationStatus::missing;
  double log_likelihood;             // under separated: what is approached
  std::vector<double> criteria;      // of the responses that were given; empty but under ok
  std::vector<int> categories_used;  // from 1
  std::vector<double> mu;            // a stimulus each; NaN of one that was never presented; empty but under ok
  std::vector<AdjacentDprime> adjacent;
  double total_dprime;  // of the last stimulus that was presented, from the first: the sum of the steps
};

struct Identification {
  std::int64_t trials = 0;
  double information_bits, stimulus_entropy_bits, response_entropy_bits;
  double jackknife_bits, miller_madow_bits, table_corrected_bits;
  double relative;  // NaN with a single stimulus
  double equivalent_classes, proportion_correct;
  std::vector<double> adjacent_loglinear;  // NaN where a stimulus of the two was never presented
  IdentificationScale ml;
};

// confusion[i][j]: how often stimulus i was named j; square, in the order of the stimuli, >= 0. All numbers are NaN
// without a trial.
Identification identification(const std::vector<std::vector<int>>& confusion);

}  // namespace jnd
