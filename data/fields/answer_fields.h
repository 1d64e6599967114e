// The blocks of results about how the answers were given, and what was answered to questions. A list refers to the
// protocol, which must outlive it.
#pragma once

#include "analysis/group/questionnaire.h"
#include "data/fields/field.h"
#include "data/results/questionnaire_results.h"
#include "data/results/study_behaviour.h"
#include "data/task_results/study_sureness.h"
#include "protocols/protocol.h"

namespace jnd {

// In JSON all of session_drift is null where there is none.
Fields<BehaviourRow> behaviour_fields(const Protocol& protocol);

// The JND from answers with sureness.
Fields<SurenessRow> sureness_fields(const Protocol& protocol);

// One cue in one condition; no file.
struct CueFitRow {
  const CueRow* row;
  std::size_t cue;
};
Fields<CueFitRow> cue_fields(const Protocol& protocol);

// One question in one condition, or asked once.
struct ScoreRow {
  const Question* question;
  const ItemScore* score;
};
Fields<ScoreRow> score_fields(const Protocol& protocol);
std::vector<ScoreRow> score_rows(const QuestionnaireItem& item, const Protocol& protocol);

// One pair of conditions by the answers to one question.
struct RatingRow {
  const PairedItemResult* item;
  const ItemPair* pair;
};
Fields<RatingRow> rating_fields(const Protocol& protocol);
std::vector<RatingRow> rating_rows(const PairedQuestionnaire& tests);

// One answer that may be chosen.
struct OptionRow {
  const Question* question;
  const ChoiceResult* choice;
  std::size_t option;
};
Fields<OptionRow> option_fields(const Protocol& protocol);
std::vector<OptionRow> option_rows(const ChoiceResult& choice, const Protocol& protocol);

Fields<Exposure> exposure_fields(const Protocol& protocol);

}  // namespace jnd
