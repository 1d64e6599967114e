#include "data/results/questionnaire_methods.h"

#include <algorithm>

#include <fmt/format.h>

#include "data/results/markdown_text.h"
#include "protocols/planning/random_stream.h"

namespace jnd {

namespace {

std::string list_of(const std::vector<std::string>& items) {
  std::string text;
  for (std::size_t i = 0; i < items.size(); ++i)
    text += (i == 0 ? "" : i + 1 == items.size() ? " and " : ", ") + items[i];
  return text;
}

const char* plural(std::size_t n) {
  return n == 1 ? "" : "s";
}

}  // namespace

std::string exploration_design(const Protocol& protocol, const StudyResults& results) {
  std::vector<std::string> conditions;
  for (const Condition& one : protocol.conditions)
    conditions.push_back(fmt::format("{} ({}{})", markdown_text(one.name), markdown_text(one.label),
                                     one.devices ? "" : "; nothing was rendered"));
  const Exploration& explore = *protocol.explore;
  const std::size_t objects = explore.objects.size();
  std::vector<std::string> names;
  for (const std::string& one : explore.objects) names.push_back(markdown_text(one));
  return fmt::format(
      "{} {} participant{} interacted freely with {} virtual object{} ({}) under {} condition{}: {}. Each condition "
      "lasted {:g} s, divided equally among the objects. The order of conditions and objects was dealt per participant "
      "from the study's seed with counter-based random streams ({}, Salmon et al. 2011). Objects had a "
      "stiffness of {:g} {}. Time in which the session was paused does not count.\n",
      results.questionnaire->participants, to_string(results.analysis.kind),
      results.questionnaire->participants == 1 ? "" : "s", objects, plural(objects), list_of(names),
      protocol.conditions.size(), plural(protocol.conditions.size()), list_of(conditions), explore.duration_s,
      kGeneratorName, protocol.stimulus.reference, to_string(protocol.stimulus.unit));
}

std::string questionnaire_tests(const StudyResults& results) {
  const QuestionnaireResults& all = *results.questionnaire;
  const auto paired = static_cast<std::size_t>(
      std::count_if(all.items.begin(), all.items.end(), [](const QuestionnaireItem& item) { return item.paired; }));
  const std::size_t once = all.items.size() - paired;
  std::string text = fmt::format(
      "{} item{} {} answered for each condition. Conditions were compared item by item with Wilcoxon's signed-rank "
      "test "
      "(Wilcoxon 1945; zero differences dropped). The p of the normal approximation with the corrections for "
      "continuity "
      "and ties, or the exact one without ties, is that of R's wilcox.test. Ratings tie, therefore the p that enters "
      "the corrections is the exact permutation p with midranks, over all changes of sign. The {} tests are one "
      "family: "
      "Holm 1979, and Benjamini and Hochberg 1995, both stand beside the uncorrected p. The effect size is the "
      "rank-biserial correlation (Kerby 2014). At alpha = {:g}, {} of {} tests fall below it as R computes them, {} by "
      "the exact p, {} with Holm's correction and {} with Benjamini and Hochberg's.\n",
      paired, plural(paired), paired == 1 ? "was" : "were", all.tests.family, all.alpha, all.below_alpha.as_r,
      all.tests.family, all.below_alpha.exact, all.below_alpha.holm, all.below_alpha.bh);
  if (once > 0)
    text += fmt::format(
        "\n{} item{} {} answered once. They have no pair and no test: mean, standard deviation, and "
        "the median with its distribution-free interval (Conover 1999, section 3.2).\n",
        once, plural(once), once == 1 ? "was" : "were");
  if (!all.choices.empty())
    text += "\nChoices are counts, with exact binomial intervals of each share (Clopper and Pearson 1934).\n";
  return text;
}

}  // namespace jnd
