#include "runner/shards/replicated_studies.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "analysis/numerics/stop_request.h"
#include "data/blocks/result_blocks.h"
#include "data/export/data_package.h"
#include "data/export/result_files.h"
#include "data/fields/number_text.h"
#include "data/files/scratch_folder.h"
#include "protocols/input/csv_table.h"
#include "protocols/input/input_error.h"
#include "protocols/input/sha256.h"
#include "runner/opening/study_access.h"
#include "runner/session/ordered_work.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

using nlohmann::ordered_json;

std::vector<ResultFile> results_of_study(const ReplicationQuestion& question, std::int64_t number) {
  Simulation simulation{question.protocol, question.rig, question.profile};
  simulation.seed = seed_of_study(question.seed, number);
  simulation.participants = question.participants;
  simulation.record = RecordPolicy::off;
  const StudyResults results = simulated_results(simulation, question.by);
  return result_files(result_blocks(results, question.protocol),
                      {{"study", "which of the simulated studies, from 1", number + 1},
                       {"seed", "of the study: jnd simulate with it makes this one again",
                        static_cast<std::int64_t>(simulation.seed)}});
}

ordered_json to_json(const ResultFile& file) {
  ordered_json columns = ordered_json::array();
  for (const DictionaryRow& row : file.dictionary)
    columns.push_back({row.column, row.meaning, row.unit, row.levels, static_cast<int>(row.type), row.several});
  return {{"file", file.name}, {"header", file.header}, {"columns", columns}, {"rows", file.rows}};
}

// Of the studies that follow. Tables of the same name have the same columns.
void add_tables(ordered_json& tables, const ordered_json& more) {
  for (const ordered_json& table : more) {
    ordered_json* known = nullptr;
    for (ordered_json& one : tables)
      if (one.at("file") == table.at("file")) known = &one;
    if (known == nullptr)
      tables.push_back(table);
    else
      known->at("rows").get_ref<std::string&>() += table.at("rows").get_ref<const std::string&>();
  }
}

DictionaryRow dictionary_row(const std::string& file, const ordered_json& column) {
  const std::int64_t type = whole_number(column.at(4), 0, static_cast<std::int64_t>(CellType::time));
  return {file,
          column.at(0).get<std::string>(),
          column.at(1).get<std::string>(),
          column.at(2).get<std::string>(),
          column.at(3).get<std::string>(),
          static_cast<CellType>(type),
          column.at(5).get<bool>()};
}

// Whether a text is as csv_line() writes it, with cells that no spreadsheet runs and no terminal obeys.
bool is_own_csv(const std::string& text, const std::vector<std::string>& columns) {
  std::string again = csv_line(columns);
  try {
    const CsvTable table = CsvTable::parse(text, "the table", columns);
    for (std::size_t row = 0; row < table.rows(); ++row) {
      std::vector<std::string> cells;
      for (const std::string& column : columns) {
        const std::string cell(table.text(row, column));
        cells.push_back(cell == "-Inf" ? cell : csv_text(cell));
      }
      again += csv_line(cells);
    }
  } catch (const InputError&) {
    return false;
  }
  const auto is_control = [](char c) { return (static_cast<unsigned char>(c) < ' ' && c != '\n') || c == '\x7f'; };
  return again == text && std::none_of(text.begin(), text.end(), is_control);
}

// Throws InputError unless the table is as to_json() makes it: a name that stays in the folder and leaves it those of
// its descriptions, and cells that no spreadsheet runs.
void require_own(const ordered_json& table) {
  const std::string_view name = table.at("file").get_ref<const std::string&>();
  const std::string_view stem = name.substr(0, name.find('.'));
  if (stem.empty() || stem == "dictionary" || name.substr(stem.size()) != ".csv" ||
      stem.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") != std::string_view::npos)
    throw InputError("a table of a name that jnd does not give");
  std::vector<std::string> names;
  for (const ordered_json& column : table.at("columns")) names.push_back(column.at(0).get<std::string>());
  const auto& rows = table.at("rows").get_ref<const std::string&>();
  if (table.at("header") != csv_line(names) || (!rows.empty() && !is_own_csv(csv_line(names) + rows, names)))
    throw InputError(fmt::format("a table {} that is not as jnd writes it", name));
}

}  // namespace

StudyResults simulated_results(const Simulation& simulation, DifferenceSource by, bool hierarchical) {
  const ScratchFolder folder("simulated");
  const std::unique_ptr<Study> study = open_or_create_study(folder.path() / "study.sqlite", simulation.protocol,
                                                            simulation.seed, {simulated_epoch_ns(1), 0});
  if (simulate_study(simulation, *study).interrupted) throw Stopped();  // what there is then is no study
  return results_of(*study, simulation.protocol, SessionKind::simulated, {.by = by, .hierarchical = hierarchical});
}

StudyShard replication_shard(const ReplicationQuestion& question, int number, int of) {
  return empty_shard(ShardKind::simulate, question.protocol,
                     {{"participants", question.participants},
                      {"studies", question.studies},
                      {"seed", question.seed},
                      {"by", to_string(question.by)},
                      {"profile", question.profile.name},
                      {"simulation_sha256", simulation_sha256(question.protocol, question.rig, question.profile)}},
                     number, of);
}

ShardWork replication_work(const ReplicationQuestion& question, int threads) {
  const auto result = [&question, threads](StudyRange range, const std::function<void(std::int64_t)>& progress) {
    const auto count = static_cast<int>(range.last - range.first);
    std::vector<std::vector<ResultFile>> files(static_cast<std::size_t>(count));
    ordered_json tables = ordered_json::array();
    work_in_order(
        count, threads,
        [&](int place) {
          files[static_cast<std::size_t>(place - 1)] = results_of_study(question, range.first + place - 1);
          return Work::finished;
        },
        [&](int place) {
          ordered_json of_study = ordered_json::array();
          for (const ResultFile& file : std::exchange(files[static_cast<std::size_t>(place - 1)], {}))
            of_study.push_back(to_json(file));
          add_tables(tables, of_study);
          if (progress) progress(place);
        });
    return tables;
  };
  return {result, add_tables};
}

void ReplicationFolder::add(const StudyShard& shard) {
  try {
    protocol_ = shard.protocol;
    studies_ = shard.studies();
    participants_ = whole_number(shard.question.at("participants"), 1, std::numeric_limits<int>::max());
    profile_ = shard.question.at("profile").get<std::string>();
    for (const ordered_json& table : shard.result.get_ref<const ordered_json::array_t&>()) {
      require_own(table);
      const auto name = table.at("file").get<std::string>(), header = table.at("header").get<std::string>();
      const auto [known, is_new] = headers_.emplace(name, header);
      if (known->second != header) throw InputError("other columns than those of the first");
      if (is_new) {
        names_.push_back(name);
        files_.append(name, header);
        for (const ordered_json& column : table.at("columns")) dictionary_.push_back(dictionary_row(name, column));
      }
      files_.append(name, table.at("rows").get_ref<const std::string&>());
    }
  } catch (const nlohmann::json::exception&) {
    throw InputError(
        fmt::format("shard {} of {}: is not one of simulated studies (make it again)", shard.number, shard.of));
  } catch (const InputError& error) {
    throw InputError(fmt::format("shard {} of {}: has {} (make it again)", shard.number, shard.of, error.what()));
  }
}

std::string ReplicationFolder::publish() {
  write_descriptions(files_, protocol_, fmt::format("results of {} simulated studies", studies_),
                     std::move(dictionary_));
  files_.publish();
  return fmt::format(
      "{}: {} {} of {}, profile {}: {}\n  one of them again, whole:  jnd simulate {} --participants {} --seed SEED --study "
      "FILE, with the seed of its rows\n",
      printable(folder_.string()), studies_, studies_ == 1 ? "study" : "studies", counted(participants_, "participant"),
      printable(profile_), fmt::join(names_, ", "), shell_word(protocol_.name), participants_);
}

}  // namespace jnd
