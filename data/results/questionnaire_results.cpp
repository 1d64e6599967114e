#include "data/results/questionnaire_results.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/numerics/special_values.h"
#include "data/log/event_body.h"
#include "data/log/exploration_body.h"
#include "data/log/storage_error.h"
#include "data/results/attendance.h"
#include "protocols/input/json_text.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

ItemScore score_of(const std::vector<double>& column, const Question& question) {
  std::vector<double> answered;
  for (const double value : column)
    if (!std::isnan(value)) answered.push_back(value);
  ItemScore score;
  score.mean = mean_with_ci(answered);
  score.median = median_interval(answered);
  if (question.kind != Question::Kind::rating) return score;
  ItemScore::Sides sides;
  const double middle = (question.min + question.max) / 2;
  for (const double value : answered) ++(value < middle ? sides.below : value > middle ? sides.above : sides.at);
  score.sides = sides;
  return score;
}

std::vector<double> column_of(const RatedQuestion& item, std::size_t columns, std::size_t column) {
  std::vector<double> values;
  for (std::size_t i = column; i < item.ratings.size(); i += columns) values.push_back(item.ratings[i]);
  return values;
}

TestCount count_below(const PairedQuestionnaire& tests, double alpha) {
  TestCount count;
  for (const PairedItemResult& item : tests.items) {
    for (const ItemPair& pair : item.pairs) {
      count.as_r += pair.test.p < alpha ? 1 : 0;
      count.exact += pair.p < alpha ? 1 : 0;
      count.holm += pair.p_holm < alpha ? 1 : 0;
      count.bh += pair.p_bh < alpha ? 1 : 0;
    }
  }
  return count;
}

// What the events say beside the ratings.
class EventReader {
 public:
  EventReader(const Protocol& protocol, std::size_t participants) : protocol_(protocol) {
    for (std::size_t i = 0; i < protocol.questions.size(); ++i) {
      const Question& question = protocol.questions[i];
      // What is asked before the session describes the participants, not what they found.
      if (question.kind != Question::Kind::choice || question.when == Question::When::before_session) continue;
      const bool each = question.per_condition || question.when == Question::When::after_condition;
      const int conditions = static_cast<int>(protocol.conditions.size());
      for (int condition = each ? 0 : -1; condition < (each ? conditions : 0); ++condition)
        chosen_.push_back({static_cast<int>(i), condition, std::vector<std::optional<std::size_t>>(participants)});
    }
    if (!protocol.explore) return;
    for (std::size_t condition = 0; condition < protocol.conditions.size(); ++condition)
      for (std::size_t object = 0; object < protocol.explore->objects.size(); ++object)
        exposure_.push_back({.condition = static_cast<int>(condition), .object = static_cast<int>(object)});
  }

  void read(const Event& event, std::size_t row) {
    try {
      if (event.kind == event_kind::kQuestionAnswered)
        read_answer(json_from(event.body), row);
      else if (event.kind == event_kind::kExploration)
        read_exploration(exploration_from(json_from(event.body), protocol_.stimulus.unit));
      else if (event.kind == event_kind::kExplorationVoided)
        read_voided(json_from(event.body));
    } catch (const nlohmann::json::exception& error) {
      throw StorageError(fmt::format("session {}, event {} ({}): the body cannot be read: {}; run jnd verify",
                                     event.session, event.seq, event.kind, error.what()));
    }
  }

  std::vector<ChoiceResult> choices() const {
    std::vector<ChoiceResult> results;
    for (const Chosen& one : chosen_) {
      const Question& question = protocol_.questions[static_cast<std::size_t>(one.question)];
      ChoiceResult result{.question = one.question, .condition = one.condition};
      std::vector<int> counts(question.options.size(), 0);
      for (const std::optional<std::size_t>& option : one.option) {
        if (!option) continue;
        ++counts[*option];
        ++result.n;
      }
      for (const int count : counts) result.options.push_back(exact_proportion(count, result.n));
      results.push_back(std::move(result));
    }
    return results;
  }

  std::vector<Exposure> exposure() const {
    std::vector<Exposure> rows = exposure_;
    for (Exposure& row : rows) row.mean_s = row.n > 0 ? row.mean_s / row.n : kNaN;
    return rows;
  }

 private:
  struct Chosen {
    int question = 0, condition = -1;
    std::vector<std::optional<std::size_t>> option;  // by participant
  };

  void read_answer(const Json& body, std::size_t row) {
    if (body.at("answer").is_null()) return;
    const auto id = body.at("question").get<std::string>();
    const Json& named = body.at("condition");
    const std::string condition = named.is_null() ? "" : named.get<std::string>();
    for (Chosen& one : chosen_) {
      const Question& question = protocol_.questions[static_cast<std::size_t>(one.question)];
      const std::string& of =
          one.condition < 0 ? condition : protocol_.conditions[static_cast<std::size_t>(one.condition)].name;
      if (question.id != id || of != condition) continue;
      const auto found =
          std::find(question.options.begin(), question.options.end(), body.at("answer").get<std::string>());
      if (found != question.options.end()) one.option[row] = static_cast<std::size_t>(found - question.options.begin());
    }
  }

  Exposure* row_of(const std::string& condition, const std::string& object) {
    for (Exposure& row : exposure_)
      if (protocol_.conditions[static_cast<std::size_t>(row.condition)].name == condition &&
          protocol_.explore->objects[static_cast<std::size_t>(row.object)] == object)
        return &row;
    return nullptr;
  }

  void read_exploration(const ExplorationRecord& record) {
    Exposure* row = row_of(record.condition, record.object);
    if (row == nullptr) return;
    row->shortest_s = row->n == 0 ? record.duration_s : std::min(row->shortest_s, record.duration_s);
    row->planned_s = std::max(row->planned_s, record.slot.duration_s);
    row->mean_s += record.duration_s;  // their sum as yet
    row->ended_early += record.ended_early ? 1 : 0;
    ++row->n;
  }

  void read_voided(const Json& body) {
    if (body.value("will_repeat", true)) return;
    if (Exposure* row = row_of(body.at("condition").get<std::string>(), body.at("object").get<std::string>()))
      ++row->given_up;
  }

  const Protocol& protocol_;
  std::vector<Chosen> chosen_;
  std::vector<Exposure> exposure_;
};

}  // namespace

QuestionnaireResults questionnaire_of(const std::vector<RatedQuestion>& items, std::size_t participants,
                                      const Protocol& protocol) {
  QuestionnaireResults results;
  results.participants = static_cast<int>(participants);
  results.alpha = protocol.analysis.tests.alpha;
  std::vector<PairedItem> paired;
  for (const RatedQuestion& rated : items) {
    const Question& question = protocol.questions[static_cast<std::size_t>(rated.question)];
    QuestionnaireItem item{rated.question, rated.paired, {}};
    const std::size_t columns = rated.columns(protocol);
    for (std::size_t column = 0; column < columns; ++column) {
      item.scores.push_back(score_of(column_of(rated, columns, column), question));
      if (rated.paired) item.scores.back().condition = static_cast<int>(column);
      if (rated.by_series) item.scores.back().series = static_cast<int>(column);
    }
    if (rated.paired) paired.push_back({question.id, {participants, columns, rated.ratings}});
    results.items.push_back(std::move(item));
  }
  results.tests = paired_questionnaire(paired);
  results.below_alpha = count_below(results.tests, results.alpha);
  return results;
}

std::vector<std::string> exposure_deviations(const ExplorationResults& results, const Protocol& protocol) {
  std::vector<std::string> sentences;
  for (const Exposure& row : results.exposure) {
    const std::string& condition = protocol.conditions[static_cast<std::size_t>(row.condition)].name;
    const std::string& object = protocol.explore->objects[static_cast<std::size_t>(row.object)];
    if (row.ended_early > 0)
      sentences.push_back(
          fmt::format("{}, {}: {} of {} explorations were ended early (the shortest after {:.0f} of {:g} s).",
                      condition, object, row.ended_early, row.n, row.shortest_s, row.planned_s));
    if (row.given_up > 0)
      sentences.push_back(fmt::format("{}, {}: {} exploration{} given up.", condition, object, row.given_up,
                                      row.given_up == 1 ? " was" : "s were"));
  }
  return sentences;
}

ExplorationResults exploration_results(const Study& study, const Protocol& protocol,
                                       const std::vector<SessionInfo>& sessions) {
  ExplorationResults results;
  const auto chosen = [](const Question& question) { return question.kind == Question::Kind::choice; };
  if (!protocol.explore && std::none_of(protocol.questions.begin(), protocol.questions.end(), chosen)) return results;
  EventReader reader(protocol, participants_of(sessions).size());
  std::size_t row = 0;
  for (std::size_t i = 0; i < sessions.size(); ++i) {
    if (i > 0 && sessions[i].participant != sessions[i - 1].participant) ++row;
    for (const Event& event : study.events(sessions[i].id)) reader.read(event, row);
  }
  results.choices = reader.choices();
  results.exposure = reader.exposure();
  return results;
}

}  // namespace jnd
