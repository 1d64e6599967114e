// The marginal likelihood of one model of everybody's answers, with its derivatives.
//
//   P(positive) = l/2 + (1 - l) F(level, s_pc, k_pc)       F: response_model.h; l, drift, over-dispersion:
//                                                          shared_parameters.h
//   ln s_pc = mu_c + u_p + v_pc,   k_pc = kappa_c + w_p
//   u ~ N(0, tu^2), w ~ N(0, tw^2) with correlation rho, v ~ N(0, tv^2), independent over participants and conditions
//
// ln L is the sum over participants of ln of the integral over u, w of the product over conditions of the integral over
// v of the likelihood of the answers: exact, in Bernoulli form (without binomial coefficients).
//
// How: the answers of a participant in a condition have a likelihood that depends on (ln s, k) alone and not on the
// parameters. It is laid out on a lattice once. What is integrated over u and w is summed over a rectangle of equally
// spaced nodes about the participant's own posterior (trapezoid rule: for what falls off like a normal density its error
// falls with exp(-2 pi^2 (sd/spacing)^2)); at every node the integral over v is a weighted sum of lattice nodes
// (lattice_kernel.h). The derivatives by all weights come from one pass backwards, and give those by all parameters.
// Of choices, whose likelihood has a corner at every level where a spread is small, no lattice lies over criteria: rows are
// computed at the nodes of w themselves.
// Nodes and lattices depend on the place alone, not on the places before it: ln L is a function.
//
// Source: Pinheiro and Bates 1995, J Comput Graph Stat 4:12 (adaptive quadrature about the posterior); Trefethen and
// Weideman 2014, SIAM Review 56:385 (the trapezoid rule). Tests: glmer of lme4 with 25 nodes and two independent
// implementations, analysis/selftest.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "analysis/hierarchical/response_lattice.h"
#include "analysis/lattice/lattice_kernel.h"

namespace jnd {

// The answers of one participant in one condition at one level (and in one half); those of the same are added up.
struct HierarchicalCell {
  int participant = 0, condition = 0;  // from 0, without gaps
  double level = 0;
  double positive = 0, negative = 0;  // whole numbers, where answers are over-dispersed
  bool second_half = false;           // of the participant's trials in the condition; without drift all are of one
  double sure_positive = 0, sure_negative = 0;  // how many of the answers were sure, where that was asked

  AnswerTally counts() const noexcept { return {positive, negative, sure_positive, sure_negative}; }
};

// Levels so near each other that nobody could tell count as one: what is computed grows with the number of different ones.
// Of a condition with more than so many, those within 5 % of each other (below a tenth of the largest one within 1 % of
// that) count at the mean of their trials. No difference is one with none.
inline constexpr std::size_t kMostLevels = 64;
// Whether levels were pooled. Of the same level, and half, a person's answers in a condition stand in one cell then.
bool pool_levels(std::vector<HierarchicalCell>& cells);

// One value of every parameter.
struct HierarchicalPlace {
  std::vector<double> mu, kappa;  // of each condition
  double tu = 0, tv = 0, tw = 0;  // >= 0
  double rho = 0;                 // -1 < rho < 1
  std::vector<double> own_tv;     // of each condition, instead of tv; or empty

  double tv_of(std::size_t condition) const noexcept { return own_tv.empty() ? tv : own_tv[condition]; }
  HierarchicalPlace& operator+=(const HierarchicalPlace& other) noexcept;  // of as many conditions
};

// Of one participant, given the answers of all conditions.
struct PersonPosterior {
  std::vector<double> mean, sd;  // of ln s in each condition
  double w = 0;                  // mean of what their criteria have beside those of the group
};

// What sets one participant apart in every condition.
struct PersonDeviation {
  double u = 0, w = 0;
};
// Where the nodes of an integral begin, in spacings.
struct NodeOffset {
  double u = 0, w = 0;
};

class HierarchicalLikelihood {
 public:
  // fineness > 1: more nodes everywhere, to check the integrals.
  HierarchicalLikelihood(std::span<const HierarchicalCell> cells, ResponseModel model, const SharedParameters& shared,
                         double fineness = 1);

  // From here on with these.
  void set_shared(const SharedParameters& shared);
  const SharedParameters& shared() const noexcept { return shared_; }

  struct Value {
    double log_likelihood = 0;       // -inf, with the slopes of the others, where somebody's underflows
    HierarchicalPlace slope;         // its derivatives; by tu, tv, tw: 0 at 0, where ln L is even
    OfSharedParameters by_shared{};  // by the shared parameters asked for
  };
  Value at(const HierarchicalPlace& given, const SharedForm& by = {});
  std::vector<PersonPosterior> posteriors(const HierarchicalPlace& given);
  // By participant, of every number of theirs (uniform in 0..1) one of the nodes of that offset, by its share of the
  // integral. The integral does not depend on where its nodes begin: over offsets drawn uniformly from 0..1, from one
  // call to the next with nothing else between, these are draws from the posterior itself.
  std::vector<std::vector<PersonDeviation>> deviations(const HierarchicalPlace& given, const NodeOffset& offset,
                                                       std::span<const std::vector<double>> numbers);

  // What a person's answers in each condition tell of ln s and the criterion there, on average: the expected information at
  // the group's mean.
  std::vector<CellInformation> told_by_one(const HierarchicalPlace& place) const;

  std::size_t participants() const noexcept { return people_.size(); }
  std::size_t conditions() const noexcept { return conditions_; }
  // What was computed since it was made, about in nanoseconds: numbers of nodes, answers and rates, each times what it
  // takes. The same on every machine.
  double work() const noexcept { return work_; }

 private:
  struct Range {
    double low = 0, high = 0;
  };
  // Of the evaluation at work: where the nodes go.
  struct Person {
    std::size_t number = 0;
    double mode_u = 0, mode_w = 0;
    Range u, w;
    double information_u = 0, information_w = 0;  // of the answers, about each alone
    double correlation = 0;                       // of u and w in the posterior
  };
  struct Rectangle {
    int u0 = 0, u1 = 0, w0 = 0, w1 = 0;
  };
  struct Evaluation;

  // Responses of a condition a step of one shared parameter beside: what log-likelihoods differ by tells the derivative.
  struct ResponsesBeside {
    SharedParameter parameter{};
    double step = 0;
    std::size_t condition = 0;
    ResponseLattice responses;
  };
  // What is known of a condition's answers on lattices of some steps.
  struct Lattice {
    ResponseLattice responses, beside;  // where rows lie at nodes the latter a step of the criterion away
    std::vector<CellLikelihood> cells;  // by participant
    LatticeRange needed;                // of the evaluation at work
    bool rows_at_nodes;                 // of w: of no use at another place
  };

  ResponseLattice& responses(std::size_t condition) noexcept { return lattices_[condition].front().responses; }
  CellLikelihood& cell(const Person& person, std::size_t condition) noexcept {
    return lattices_[condition].front().cells[person.number];
  }
  const ResponseLattice& responses(std::size_t condition) const noexcept {
    return lattices_[condition].front().responses;
  }
  const CellLikelihood& cell(const Person& person, std::size_t condition) const noexcept {
    return lattices_[condition].front().cells[person.number];
  }
  void look_beside(const HierarchicalPlace& place, const SharedForm& by);
  OfSharedParameters slope_by_shared(const Person& person, const Evaluation& at);
  LatticeSteps steps_about(std::size_t condition, const HierarchicalPlace& place) const;
  void choose_lattices(const HierarchicalPlace& place);
  void locate(Person& person, const HierarchicalPlace& place) const;
  std::vector<std::size_t> alike(std::vector<std::size_t> people, const HierarchicalPlace& place) const;
  Evaluation prepared(const HierarchicalPlace& place, const NodeOffset& offset, std::span<const std::size_t> people);
  template <typename Each>
  void through_everybody(const HierarchicalPlace& place, Each&& each, const NodeOffset& offset = {},
                         const SharedForm& by = {});
  Rectangle rectangle_of(const Person& person, const Evaluation& evaluation) const;
  bool settled(Person& person, Evaluation& at);
  void integrate(Person& person, Evaluation& at);
  bool grown(Person& person, const Evaluation& at) const;
  void go_back(Evaluation& at) const;
  double log_of(const Person& person, const Evaluation& at) const;
  HierarchicalPlace slope_of(const Evaluation& at) const;
  bool choice() const noexcept { return model_ == ResponseModel::choice; }
  void lay_out_rows(std::size_t condition, const LatticeRange& needed, double origin, double spacing);
  bool fine_enough(Person& person, const Evaluation& at) const;

  ResponseModel model_;
  SharedParameters shared_;
  double reach_;     // 1, or more or less: how far out an integral goes
  double fineness_;  // how close its nodes lie
  std::size_t conditions_ = 0;
  // By condition: what was asked, and the lattice of now before some earlier ones.
  std::vector<std::vector<LatticeQuestion>> questions_;
  std::vector<std::vector<Lattice>> lattices_;
  std::vector<ResponsesBeside> beside_;
  std::vector<Person> people_;
  double work_ = 0;
};

}  // namespace jnd
