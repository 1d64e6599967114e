#include "analysis/selftest/reference_numbers.h"

#include <functional>
#include <map>
#include <stdexcept>
#include <string>

#include "analysis/numerics/special_values.h"
#include "analysis/selftest/reference_texts.h"

namespace jnd {

const nlohmann::json& reference_numbers(std::string_view subject) {
  static const auto read = [] {
    std::map<std::string, nlohmann::json, std::less<>> files;
    for (const ReferenceText& one : kReferenceTexts) files.emplace(one.subject, nlohmann::json::parse(one.text));
    return files;
  }();
  const auto found = read.find(subject);
  if (found == read.end()) throw std::out_of_range("no reference numbers of " + std::string(subject));
  return found->second;
}

double reference_number(const nlohmann::json& value) {
  if (value.is_number()) return value.get<double>();
  if (value.is_null() || value == "NaN" || value == "NA") return kNaN;
  if (value == "Inf") return kInf;
  if (value == "-Inf") return -kInf;
  throw std::invalid_argument("not a reference number: " + value.dump());
}

QuestParameters reference_quest() {
  const nlohmann::json& given = reference_numbers("adaptive").at("quest").at("parameters");
  QuestParameters parameters;
  parameters.t_guess = given.at("t_guess");
  parameters.t_guess_sd = given.at("t_guess_sd");
  parameters.p_threshold = given.at("p_threshold");
  parameters.beta = given.at("beta");
  parameters.delta = given.at("delta");
  parameters.gamma = given.at("gamma");
  parameters.grain = given.at("grain");
  parameters.range = given.at("range");
  return parameters;
}

}  // namespace jnd
