// The results of every task, whatever sets its levels: the same blocks, in which one name means one thing, and nothing is
// missing without a reason.
#include <cmath>
#include <map>
#include <set>
#include <string>

#include "data/blocks/result_blocks.h"
#include "data/results/study_models.h"
#include "protocols/planning/track_threshold.h"
#include "tests/catch.h"
#include "tests/data/small_studies.h"

namespace jnd {
namespace {

// What a task measures has its own words in estimates.csv: how a "jnd" comes about differs from task to task.
bool is_outcome(const Block& block, const std::string& column, const TaskResults& task) {
  const auto is = [&](const TaskOutcome& outcome) {
    const std::string key(outcome.key);
    return column == key || column == key + "_ci_low" || column == key + "_ci_high";
  };
  return block.id == "estimates" && std::any_of(task.outcomes.begin(), task.outcomes.end(), is);
}

TEST_CASE("a column's name has one meaning wherever it stands, and no two blocks share a name", "[data]") {
  std::map<std::string, std::string> meanings, first_in;
  std::set<std::string> blocks_seen;
  for (const SmallStudy& study : small_studies()) {
    std::optional<StudyModels> models;
    if (!study.results.task.cells.empty()) models = study_models(study.results.task, study.protocol);
    std::set<std::string> ids;
    for (const Block& block : result_blocks(study.results, study.protocol, models ? &*models : nullptr)) {
      CAPTURE(study.name, block.id);
      CHECK(ids.insert(block.id).second);
      blocks_seen.insert(block.id);
      CHECK(block.rows() > 0);
      std::set<std::string> keys, columns;
      for (const FieldCore& field : block.fields) {
        CAPTURE(field.key);
        CHECK(keys.insert(field.key).second);
        if (field.place == Place::table) continue;
        CHECK(columns.insert(field.column).second);
        CHECK_FALSE(field.meaning.empty());
        if (is_outcome(block, field.column, study.results.task)) continue;
        const auto [known, is_new] = meanings.try_emplace(field.column, field.meaning);
        if (is_new) first_in[field.column] = study.name + ", " + block.id;
        INFO("first in " << first_in[field.column]);
        CHECK(known->second == field.meaning);
      }
      // What a table shows is there.
      for (const std::vector<TableColumn>* const shown : {&block.columns, &block.answer.columns})
        for (const TableColumn& column : *shown) {
          CAPTURE(column.key, column.second);
          CHECK(block.has(column.key));
          CHECK((column.second.empty() || block.has(column.second)));
        }
    }
  }
  for (const char* id : {"estimates",
                         "tracks",
                         "group",
                         "cells",
                         "counts",
                         "curves",
                         "proportion",
                         "contrasts",
                         "groups",
                         "between",
                         "group_pairs",
                         "conditions",
                         "tests",
                         "pairs",
                         "values",
                         "condition_by_series",
                         "hierarchical",
                         "hierarchical_ratios",
                         "hierarchical_people",
                         "hierarchical_check",
                         "sensitivity",
                         "models",
                         "model_cells",
                         "behaviour",
                         "cues",
                         "sureness",
                         "items",
                         "ratings",
                         "choices",
                         "exposure"}) {
    CAPTURE(id);
    CHECK(blocks_seen.contains(id));
  }
}

// Whether a number is there, or a status says why not.
void check_told(const Block& block, const std::string& number, const std::string& status) {
  for (std::size_t row = 0; row < block.rows(); ++row) {
    CAPTURE(block.id, row, number, block.text(row, status));
    CHECK(std::isnan(block.number(row, number)) == (block.text(row, status) != "ok"));
  }
}

TEST_CASE("every task with every procedure has estimates, a group and comparisons, and says what is missing",
          "[data]") {
  std::set<std::string> names;
  for (const SmallStudy& study : small_studies()) {
    const TaskResults& task = study.results.task;
    names.insert(study.name);
    if (study.protocol.explore) continue;  // it has no trials
    CAPTURE(study.name);
    const std::vector<Block> blocks = result_blocks(study.results, study.protocol);
    const auto block = [&](const char* id) -> const Block& {
      const Block* const found = block_named(blocks, id);
      INFO(id);
      REQUIRE(found != nullptr);
      return *found;
    };
    const std::size_t places = 2 * judged_standard_count(study.protocol);
    const auto participants = static_cast<std::size_t>(study.results.attendance.participants);

    const Block& estimates = block("estimates");
    CHECK(estimates.rows() == participants * places);
    std::map<std::string, std::size_t> values;  // by outcome
    for (std::size_t row = 0; row < estimates.rows(); ++row) {
      CHECK(estimates.number(row, "trials") > 0);
      for (const TaskOutcome& outcome : task.outcomes) {
        const std::string key(outcome.key);
        CAPTURE(row, key);
        const bool there = !std::isnan(estimates.number(row, key));
        values[key] += there ? 1 : 0;
        // The status of the tracks stands in tracks.csv.
        if (outcome.own_status)
          CHECK(there == (estimates.text(row, key + "_status") == "ok"));
        else if (outcome.key != kTrackThreshold)
          CHECK((there || estimates.text(row, "status") != "ok"));
      }
    }
    CHECK(values[std::string(task.outcomes[task.registered].key)] > estimates.rows() / 2);

    CHECK((block_named(blocks, "tracks") != nullptr) == study.protocol.design.procedure.has_value());
    if (study.protocol.design.procedure) {
      const Block& tracks = block("tracks");
      CHECK(tracks.rows() == participants * places * 2);  // one track, and all of them
      for (std::size_t row = 0; row < tracks.rows(); ++row)
        CHECK((!std::isnan(tracks.number(row, "threshold")) || tracks.text(row, "status") != "ok"));
    }

    const Block& group = block("group");
    CHECK(group.rows() == places * task.outcomes.size());
    for (std::size_t row = 0; row < group.rows(); ++row) {
      CAPTURE(row, group.text(row, "outcome"));
      const double n = group.number(row, "n");
      CHECK(static_cast<std::size_t>(group.number(row, "participants")) == participants);
      CHECK(std::isnan(group.number(row, "mean")) == (n == 0));
      CHECK(std::isnan(group.number(row, "ci_low")) == (n < 2));
      CHECK(group.text(row, "without").empty() == (n == group.number(row, "participants")));
      CHECK(!group.text(row, "without").ends_with(" ok"));
    }

    const Block &conditions = block("conditions"), &tests = block("tests"), &pairs = block("pairs");
    CHECK(conditions.rows() == 2 * 2);  // the registered outcome, and time
    check_told(conditions, "sd", "status");
    check_told(conditions, "shapiro.p", "shapiro.status");
    CHECK(tests.rows() == 2);
    check_told(tests, "anova.p", "anova.status");
    check_told(tests, "friedman.p", "friedman.status");
    CHECK(tests.text(0, "outcome").ends_with(task.outcomes[task.registered].key));
    for (const char* test : {"t", "games_howell", "tukey", "wilcoxon"})
      check_told(pairs, std::string(test) + ".p", std::string(test) + ".status");
    CHECK(block("values").rows() == 2 * 2 * participants);

    const Block& contrasts = block("contrasts");
    CHECK(contrasts.flag(0, "registered"));
    for (std::size_t row = 0; row < contrasts.rows(); ++row) {
      CAPTURE(row, contrasts.text(row, "outcome"));
      CHECK(std::isnan(contrasts.number(row, "mean_difference")) == (contrasts.number(row, "n") == 0));
      if (contrasts.flag(row, "registered"))
        CHECK(std::isnan(contrasts.number(row, "p_registered")) != contrasts.text(row, "refused").empty());
    }
    if (block_named(blocks, "hierarchical") != nullptr) check_told(block("hierarchical"), "jnd", "status");
  }
  for (const auto& [word, kind] : kTaskWords) CHECK(names.contains(std::string(word)));
  CHECK(names.size() == 9 + 3 + 3 + 3 + 2 + 2 + 1);
}

}  // namespace
}  // namespace jnd
