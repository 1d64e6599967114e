#include "data/results/rating_answers.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <string>
#include <unordered_map>

#include "analysis/numerics/special_values.h"
#include "data/study/study_impl.h"
#include "protocols/course/course.h"
#include "protocols/planning/plan.h"

namespace jnd {

namespace {

struct Tally {
  double sum = 0;
  int n = 0;
};

int condition_place_of(const Protocol& protocol, const std::string& name) {
  for (std::size_t i = 0; i < protocol.conditions.size(); ++i)
    if (protocol.conditions[i].name == name) return static_cast<int>(i);
  return -1;
}

// Which series is over when a session comes to a question: places in the protocol, by the event's after_trial.
std::map<int, int> series_over(const Protocol& protocol, const Plan& plan) {
  std::map<int, int> over;
  for (const CourseBlock& block : course_blocks(protocol, plan))
    if (block.series_over) over.emplace(block.planned, plan.series_order[over.size()]);
  return over;
}

// A row for each session.
std::vector<RatedQuestion> ratings_by_session(const Study& study, const Protocol& protocol,
                                              const std::vector<SessionInfo>& sessions) {
  std::vector<RatedQuestion> questions;
  std::unordered_map<std::string, std::size_t> by_id;
  std::vector<std::vector<Tally>> tallies;
  for (std::size_t i = 0; i < protocol.questions.size(); ++i) {
    const Question& question = protocol.questions[i];
    if (question.kind != Question::Kind::rating && question.kind != Question::Kind::number) continue;
    RatedQuestion rated;
    rated.question = static_cast<int>(i);
    rated.paired = question.per_condition || question.when == Question::When::after_condition;
    rated.by_series = question.when == Question::When::after_series && protocol.series.size() > 1;
    by_id.emplace(question.id, questions.size());
    tallies.emplace_back(sessions.size() * rated.columns(protocol));
    questions.push_back(std::move(rated));
  }
  if (questions.empty()) return questions;

  std::unordered_map<std::string, std::size_t> places;
  for (std::size_t i = 0; i < sessions.size(); ++i) places.emplace(sessions[i].id, i);
  std::vector<std::map<int, int>> over(sessions.size());
  if (std::any_of(questions.begin(), questions.end(), [](const RatedQuestion& one) { return one.by_series; }))
    for (std::size_t i = 0; i < sessions.size(); ++i)
      over[i] = series_over(protocol,
                            make_plan(protocol, sessions[i].participant_number, study.info().seed, sessions[i].number));
  const Study::Impl& impl = study.impl();
  const std::scoped_lock lock(impl.mutex);
  with_storage_errors(impl.path, [&] {
    SQLite::Statement query(
        impl.database(),
        "SELECT session, json_extract(body, '$.question'), json_extract(body, '$.condition'), "
        "json_extract(body, '$.answer'), json_extract(body, '$.after_trial') FROM event WHERE kind = 'questionnaire.answered'");
    while (query.executeStep()) {
      const auto session = places.find(query.getColumn(0).getString());
      const auto found = by_id.find(query.getColumn(1).getString());
      if (session == places.end() || found == by_id.end() || query.getColumn(3).isNull()) continue;
      const RatedQuestion& question = questions[found->second];
      int column = 0;
      if (question.paired) column = condition_place_of(protocol, query.getColumn(2).getString());
      if (question.by_series) {
        const auto series = over[session->second].find(query.getColumn(4).getInt());
        column = series == over[session->second].end() ? -1 : series->second;
      }
      if (column < 0) continue;
      const std::string text = query.getColumn(3).getString();
      double value = 0;
      if (std::from_chars(text.data(), text.data() + text.size(), value).ec != std::errc()) continue;
      Tally& tally =
          tallies[found->second][session->second * question.columns(protocol) + static_cast<std::size_t>(column)];
      tally.sum += value;
      ++tally.n;
    }
    return 0;
  });
  for (std::size_t i = 0; i < questions.size(); ++i)
    for (const Tally& tally : tallies[i]) questions[i].ratings.push_back(tally.n > 0 ? tally.sum / tally.n : kNaN);
  return questions;
}

}  // namespace

std::vector<RatedQuestion> read_ratings(const Study& study, const Protocol& protocol,
                                        const std::vector<SessionInfo>& sessions) {
  std::vector<RatedQuestion> questions = ratings_by_session(study, protocol, sessions);
  for (RatedQuestion& question : questions) {
    const std::size_t columns = question.columns(protocol);
    std::vector<Tally> tallies;
    for (std::size_t session = 0; session < sessions.size(); ++session) {
      if (session == 0 || sessions[session].participant != sessions[session - 1].participant)
        tallies.resize(tallies.size() + columns);
      for (std::size_t column = 0; column < columns; ++column) {
        const double rating = question.ratings[session * columns + column];
        if (std::isnan(rating)) continue;
        Tally& tally = tallies[tallies.size() - columns + column];
        tally.sum += rating;
        ++tally.n;
      }
    }
    question.ratings.clear();
    for (const Tally& tally : tallies) question.ratings.push_back(tally.n > 0 ? tally.sum / tally.n : kNaN);
  }
  return questions;
}

}  // namespace jnd
