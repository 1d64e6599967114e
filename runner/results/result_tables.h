// The tables of a study's results, as people read them: `analyze` prints them, `report` sets them in HTML.
#pragma once

#include <string>
#include <vector>

#include "data/results/study_models.h"
#include "data/results/study_results.h"

namespace jnd {

struct ResultTable {
  struct Column {
    std::string name;
    bool number = false;  // aligned to the right
  };
  std::string id;     // "participants", "group", ...: for links and the names of files
  std::string title;  // "Participants"
  std::string note;   // the convention behind the numbers; empty where there is nothing to say
  std::vector<Column> columns;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> footnotes;  // below the table
};

// In the order in which they are read. Tables without rows are left out.
std::vector<ResultTable> result_tables(const StudyResults& results, const Protocol& protocol);

// What of the results a table is about.
enum class Section { participants, tests, models, behaviour, questions, cells };
Section section_of(const ResultTable& table);

// Every model beside the registered one, by participant and condition.
ResultTable models_table(const StudyModels& models, const Protocol& protocol);

}  // namespace jnd
