#include "runner/shards/replicated_studies.h"

#include <utility>

#include <fmt/format.h>

#include "analysis/numerics/stop_request.h"
#include "data/export/data_package.h"
#include "data/export/result_columns.h"
#include "data/files/scratch_folder.h"
#include "protocols/input/input_error.h"
#include "protocols/input/sha256.h"
#include "runner/opening/study_access.h"
#include "runner/session/ordered_work.h"
#include "runner/terminal/number_text.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

using nlohmann::ordered_json;

std::vector<ResultFile> results_of_study(const ReplicationQuestion& question, std::int64_t number) {
  Simulation simulation{question.protocol, question.rig, question.profile};
  simulation.seed = seed_of_study(question.seed, number);
  simulation.participants = question.participants;
  simulation.record = RecordPolicy::off;
  return result_files(simulated_results(simulation, question.by), question.protocol, nullptr,
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
  const int type = column.at(4).get<int>();
  if (type < 0 || type > static_cast<int>(CellType::time)) throw InputError("a type of cells that is not known");
  return {file,
          column.at(0).get<std::string>(),
          column.at(1).get<std::string>(),
          column.at(2).get<std::string>(),
          column.at(3).get<std::string>(),
          static_cast<CellType>(type),
          column.at(5).get<bool>()};
}

}  // namespace

StudyResults simulated_results(const Simulation& simulation, DifferenceSource by) {
  const ScratchFolder folder("simulated");
  const std::unique_ptr<Study> study = open_or_create_study(folder.path() / "study.sqlite", simulation.protocol,
                                                            simulation.seed, {simulated_epoch_ns(1), 0});
  if (simulate_study(simulation, *study).interrupted) throw Stopped();  // what there is then is no study
  return results_of(*study, simulation.protocol, SessionKind::simulated, by);
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
    for (const ordered_json& table : shard.result) {
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
  protocol_ = shard.protocol;
  question_ = shard.question;
}

std::string ReplicationFolder::publish() {
  const auto studies = question_.at("studies").get<std::int64_t>();
  const int participants = question_.at("participants").get<int>();
  write_descriptions(files_, protocol_, fmt::format("results of {} simulated studies", studies),
                     std::move(dictionary_));
  files_.publish();
  return fmt::format(
      "{}: {} {} of {}, profile {}: {}\n  one of them again, whole:  jnd simulate {} --participants {} --seed SEED --study "
      "FILE, with the seed of its rows\n",
      printable(folder_.string()), studies, studies == 1 ? "study" : "studies", counted(participants, "participant"),
      printable(question_.at("profile").get<std::string>()), fmt::join(names_, ", "), printable(protocol_.name),
      participants);
}

}  // namespace jnd
