// What was answered to questions: ratings and numbers by condition with their tests, those given once; of a study of
// free interaction also choices, and how long each participant really explored.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "analysis/group/group.h"
#include "analysis/group/questionnaire.h"
#include "analysis/numerics/binomial.h"
#include "data/results/rating_answers.h"
#include "data/study/study.h"
#include "protocols/protocol.h"

namespace jnd {

// The answers to one question of kind rating or number in one condition, over the participants who answered.
struct ItemScore {
  int condition = -1;  // place in Protocol::conditions; -1: not of one
  int series = -1;     // place in Protocol::series; -1: not of one
  MeanEstimate mean;
  MedianInterval median;
  // Ratings below, on and above the middle of the scale; none of numbers, whose range is only what may be typed.
  struct Sides {
    int below = 0, at = 0, above = 0;
  };
  std::optional<Sides> sides;
};

struct QuestionnaireItem {
  int question = 0;  // place in Protocol::questions
  bool paired = false;
  std::vector<ItemScore> scores;  // a condition each, or a series, or one
};

// One question with options, asked after a condition or the session.
struct ChoiceResult {
  int question = 0;
  int condition = -1;                      // -1: asked once
  int n = 0;                               // who chose
  std::vector<ExactProportion> options{};  // as in Question::options; exact binomial intervals, one by one
};

// One object in one condition, over the participants who explored it.
struct Exposure {
  int condition = 0, object = 0;  // places in the protocol
  int n = 0;
  double planned_s = 0, mean_s = 0, shortest_s = 0;
  int ended_early = 0;
  int given_up = 0;  // participants in whom it was given up
};

// How many of a family of tests fall below a level.
struct TestCount {
  std::size_t as_r = 0, exact = 0, holm = 0, bh = 0;
};

struct QuestionnaireResults {
  int participants = 0;
  std::vector<QuestionnaireItem> items;  // in the protocol's order
  PairedQuestionnaire tests;             // of the paired items, in the same order; their family is all of them
  double alpha = 0.05;
  TestCount below_alpha;
};

// Choices of any study; of free interaction also how long it took.
struct ExplorationResults {
  std::vector<ChoiceResult> choices;
  std::vector<Exposure> exposure;  // by condition, object
};

// What follows from the ratings alone: scores, tests and their count. participants: the rows.
QuestionnaireResults questionnaire_of(const std::vector<RatedQuestion>& items, std::size_t participants,
                                      const Protocol& protocol);

// One sentence for each object of a condition that some participants explored for less than planned, or not at all.
std::vector<std::string> exposure_deviations(const ExplorationResults& results, const Protocol& protocol);

// sessions: of one kind, by participant; one with several has the choice of the last. Throws StorageError.
ExplorationResults exploration_results(const Study& study, const Protocol& protocol,
                                       const std::vector<SessionInfo>& sessions);

}  // namespace jnd
