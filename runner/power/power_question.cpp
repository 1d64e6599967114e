#include "runner/power/power_question.h"

#include <cmath>
#include <stdexcept>

#include "protocols/tasks/task.h"

namespace jnd {

std::vector<PowerDesign> PowerQuestion::designs() const {
  std::vector<PowerDesign> designs;
  const std::vector<int> counts = trials.empty() ? std::vector<int>{0} : trials;
  for (const int people_count : participants)
    for (const int of_cell : counts)
      for (const double effect : effects) designs.push_back({people_count, of_cell, effect});
  return designs;
}

std::vector<GroupTest> registered_group_tests(const Protocol& protocol) {
  const BetweenTest registered = protocol.analysis.tests.between;
  if (protocol.groups.empty() || registered == BetweenTest::none) return {};
  if (registered == BetweenTest::mixed_anova)
    return {{.kind = GroupTest::Kind::groups}, {.kind = GroupTest::Kind::interaction}};
  std::vector<GroupTest> pairs;
  const auto groups = static_cast<int>(protocol.groups.size());
  for (int a = 0; a < groups; ++a)
    for (int b = a + 1; b < groups; ++b) pairs.push_back({GroupTest::Kind::pair, a, b});
  return pairs;
}

double group_shift(const PowerQuestion& question, double effect, std::optional<int> group,
                   std::size_t condition) noexcept {
  if (!group || question.group_factors.empty()) return 0;
  return effect * std::log(question.group_factors[static_cast<std::size_t>(*group)][condition]);
}

std::optional<ResponseModel> response_model_of(const Protocol& protocol) {
  const std::optional<AnswerModel> answers = task_of(protocol.task.kind).answer_model(protocol);
  return answers ? std::optional(answers->response) : std::nullopt;
}

double usual_criterion(ResponseModel model) noexcept {
  switch (model) {
    case ResponseModel::yes_no:
      return 0.75;
    case ResponseModel::differencing:
      return 0.5;
    case ResponseModel::independent:
    case ResponseModel::choice:
      break;
  }
  return 0;
}

HierarchicalPlace truth_of(const PowerQuestion& question, double effect, const Protocol& protocol) {
  // The JND of choices is meant as registered, at 75 % or 84 % or d' = 1; s is the noise of the felt difference.
  const AnswerModel answers = task_of(protocol.task.kind).answer_model(protocol).value();
  const bool choice = answers.response == ResponseModel::choice;
  const double of_noise = answers.jnd_of_s;
  double mean = 0;
  for (const double jnd : question.jnds) mean += std::log(jnd / of_noise) / static_cast<double>(question.jnds.size());
  const double unit = choice ? std::exp(mean) : 1;
  HierarchicalPlace truth;
  for (const double jnd : question.jnds) {
    truth.mu.push_back(mean + effect * (std::log(jnd / of_noise) - mean));
    truth.kappa.push_back(question.people.criterion * unit);
  }
  truth.tu = std::sqrt(std::log1p(question.people.between_cv * question.people.between_cv));
  truth.tv = std::sqrt(std::log1p(question.people.interaction_cv * question.people.interaction_cv));
  truth.tw = question.people.criterion_sd * unit;
  return truth;
}

namespace {

constexpr auto kGroupTestWords = words<GroupTest::Kind>({{"pair", GroupTest::Kind::pair},
                                                         {"groups", GroupTest::Kind::groups},
                                                         {"groups x conditions", GroupTest::Kind::interaction}});

}  // namespace

nlohmann::ordered_json to_json(const PowerQuestion& question) {
  nlohmann::ordered_json group_tests = nlohmann::ordered_json::array();
  for (const GroupTest& one : question.group_tests) {
    nlohmann::ordered_json& row = group_tests.emplace_back();
    row["test"] = word_of(kGroupTestWords, one.kind);
    if (one.kind == GroupTest::Kind::pair) row["groups"] = {one.a, one.b};
  }
  nlohmann::ordered_json analyses = nlohmann::ordered_json::array();
  for (const PowerAnalysis one : question.analyses) analyses.push_back(word_of(kPowerAnalysisWords, one));
  return {{"participants", question.participants},
          {"trials", question.trials},
          {"effects", question.effects},
          {"jnds", question.jnds},
          {"contrasts", question.contrasts},
          {"group_tests", group_tests},
          {"group_factors", question.group_factors},
          {"between_cv", question.people.between_cv},
          {"interaction_cv", question.people.interaction_cv},
          {"criterion", question.people.criterion},
          {"criterion_sd", question.people.criterion_sd},
          {"lapse", question.people.lapse},
          {"drop_out", question.people.drop_out},
          {"analyses", analyses},
          {"studies", question.studies},
          {"seed", question.seed},
          {"wanted_power", question.wanted},
          {"profile", question.profile ? nlohmann::ordered_json(*question.profile) : nlohmann::ordered_json(nullptr)},
          {"simulation_sha256", question.simulation_sha256}};
}

PowerQuestion power_question_from(const nlohmann::ordered_json& json) {
  PowerQuestion question;
  json.at("participants").get_to(question.participants);
  json.at("trials").get_to(question.trials);
  json.at("effects").get_to(question.effects);
  json.at("jnds").get_to(question.jnds);
  json.at("contrasts").get_to(question.contrasts);
  for (const auto& row : json.at("group_tests")) {
    const auto kind = value_of(kGroupTestWords, row.at("test").get<std::string>());
    if (!kind) throw std::invalid_argument("a test of groups that is not known");
    GroupTest& one = question.group_tests.emplace_back();
    one.kind = *kind;
    if (*kind != GroupTest::Kind::pair) continue;
    row.at("groups").at(0).get_to(one.a);
    row.at("groups").at(1).get_to(one.b);
  }
  json.at("group_factors").get_to(question.group_factors);
  json.at("between_cv").get_to(question.people.between_cv);
  json.at("interaction_cv").get_to(question.people.interaction_cv);
  json.at("criterion").get_to(question.people.criterion);
  json.at("criterion_sd").get_to(question.people.criterion_sd);
  json.at("lapse").get_to(question.people.lapse);
  json.at("drop_out").get_to(question.people.drop_out);
  for (const auto& word : json.at("analyses")) {
    const auto analysis = value_of(kPowerAnalysisWords, word.get<std::string>());
    if (!analysis) throw std::invalid_argument("an analysis that is not known");
    question.analyses.push_back(*analysis);
  }
  json.at("studies").get_to(question.studies);
  json.at("seed").get_to(question.seed);
  json.at("wanted_power").get_to(question.wanted);
  json.at("simulation_sha256").get_to(question.simulation_sha256);
  if (!json.at("profile").is_null()) question.profile = json.at("profile").get<std::string>();
  return question;
}

}  // namespace jnd
