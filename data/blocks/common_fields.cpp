#include "data/blocks/common_fields.h"

#include <array>
#include <stdexcept>
#include <utility>

namespace jnd {

std::string_view common_meaning(std::string_view key) {
  using Entry = std::pair<std::string_view, std::string_view>;
  static constexpr std::array kMeanings = {
      Entry{"participant", "code of the participant; all: everyone together"},
      Entry{"kind", "kind of the sessions"},
      Entry{"group", "group of the participant, or of participants that the row is about"},
      Entry{"condition", "condition; empty where all are meant together"},
      Entry{"a", "first of the two that are compared"},
      Entry{"b", "second of them"},
      Entry{"series", "series"},
      Entry{"standard", "name of the standard; all: the numbers are of all series together"},
      Entry{"standard_value", "value of the standard; empty where the task has none"},
      Entry{"outcome",
            "what is measured or compared: a column of estimates.csv (ln_ before it: its logarithm), trial_time, "
            "a question, or hierarchical_ln_jnd: ln of a ratio of JNDs by the hierarchical model"},
      Entry{"title", "the same in words"},
      Entry{"unit", "unit of the numbers in the row; empty where they have none"},
      Entry{"registered", "1 for what the protocol registers, 0 for what stands beside it"},
      Entry{"participants", "participants whom the row is about, with a value or without"},
      Entry{"n",
            "what the numbers of the row rest on: so many participants, pairs of values, averaged reversals or trials"},
      Entry{"trials", "counted trials"},
      Entry{"excluded", "trials left out by a registered rule"},
      Entry{"missing", "planned trials without an answer"},
      Entry{"mean", "mean"},
      Entry{"mean_difference", "mean of a - b"},
      Entry{"sd", "standard deviation, n - 1 in the denominator"},
      Entry{"median",
            "median; of JNDs who lies above or below every value counts there, and it is Inf or empty where such a "
            "one stands in the middle"},
      Entry{"ci_low", "lower end of the 95 % interval of the estimate in the row; methods.md says which interval"},
      Entry{"ci_high", "upper end of that interval"},
      Entry{
          "ci_status",
          "whether that interval was found; not_computed: nobody asked, or there is no estimate; "
          "not_converged: an end could not be confirmed; by_curvature: the search took too long, so interval and test are Wald's; "
          "out_of_work: there is not even that one"},
      Entry{"ci_within_low",
            "lower end of the within-subject 95 % interval (Cousineau 2005, Morey 2008), for comparing "
            "conditions"},
      Entry{"ci_within_high", "upper end of that interval"},
      Entry{"t", "t of the test in the row"},
      Entry{"df", "degrees of freedom of that test"},
      Entry{"p", "p of the test in the row, without correction for other tests"},
      Entry{"p_holm", "that p with Holm's correction over the rows that are tested together"},
      Entry{"p_bh", "that p with Benjamini and Hochberg's correction"},
      Entry{"lr", "likelihood-ratio chi-square of that test; where ci_status is by_curvature Wald's"},
      Entry{"status", "ok, or why the numbers of the row are not there"},
      Entry{"refused", "why there is no test; empty where there is one"},
      Entry{"test", "the registered test"},
      Entry{"model", "model of d'"},
      Entry{"correction", "correction of rates of 0 and 1; none of maximum likelihood"},
      Entry{"method", "how the JND comes from d' at several differences"},
      Entry{"difference_source", "the differences behind the numbers: as asked, or as delivered"},
      Entry{"protocol_sha256", "SHA-256 of the protocol's bytes"},
      Entry{"slope", "slope of d' on the difference of the stimuli, through the origin"},
      Entry{"jnd", "just-noticeable difference, as the protocol means it; empty where a status says why"},
      Entry{"weber", "Weber fraction: JND / standard"},
      Entry{"published", "what the protocol's source printed; empty where it printed nothing"},
      Entry{"item", "identifier of the question"},
      Entry{"text", "the question"},
      Entry{"hits", "answers \"different\" to different stimuli, or of a track those that were right"},
      Entry{"false_alarms", "answers \"different\", or \"yes\", where there was nothing to notice"},
      Entry{"false_alarm_rate", "rate of false alarms"},
      Entry{"log_likelihood", "at the estimate, without binomial constants"}};
  for (const auto& [name, meaning] : kMeanings)
    if (name == key) return meaning;
  throw std::logic_error("no common field is called " + std::string(key));
}

std::string group_levels(const Protocol& protocol) {
  std::string levels;
  for (const std::string& name : group_names(protocol)) levels.append(levels.empty() ? "" : " ").append(name);
  return levels;
}

const PublishedValue* published_value(const Protocol& protocol, std::string_view condition, int standard,
                                      std::string_view quantity, std::string_view question) {
  const PublishedValue* of_all = nullptr;
  for (const PublishedValue& value : protocol.published) {
    if (value.quantity != quantity || value.question != question ||
        (!condition.empty() && value.condition != condition))
      continue;
    if (value.standard == standard) return &value;
    if (value.standard < 0 && of_all == nullptr) of_all = &value;
  }
  return of_all;
}

int slope_step(const Protocol& protocol) noexcept {
  return protocol.stimulus.unit == Unit::n_per_m ? 100 : 10;
}

std::string joined(const std::string& a, const std::string& b) {
  return a.empty() || b.empty() ? a + b : a + ", " + b;
}

}  // namespace jnd
