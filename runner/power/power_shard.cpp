#include "runner/power/power_shard.h"

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "protocols/input/input_error.h"
#include "runner/power/power_study.h"

namespace jnd {

namespace {

using nlohmann::ordered_json;

// Whether every place that the question names is one of the protocol.
bool fits(const PowerQuestion& question, const Protocol& protocol) {
  const std::size_t conditions = protocol.conditions.size(), groups = protocol.groups.size();
  const auto is_below = [](int place, std::size_t size) {
    return place >= 0 && static_cast<std::size_t>(place) < size;
  };
  const auto is_pair = [&](const std::array<int, 2>& pair) {
    return is_below(pair[0], conditions) && is_below(pair[1], conditions);
  };
  const auto is_test = [&](const GroupTest& one) { return is_below(one.a, groups) && is_below(one.b, groups); };
  const auto is_whole = [&](const std::vector<double>& factors) { return factors.size() == conditions; };
  return response_model_of(protocol) && is_whole(question.jnds) &&
         std::all_of(question.contrasts.begin(), question.contrasts.end(), is_pair) &&
         std::all_of(question.group_tests.begin(), question.group_tests.end(), is_test) &&
         (question.group_factors.empty() || question.group_factors.size() == groups) &&
         std::all_of(question.group_factors.begin(), question.group_factors.end(), is_whole);
}

// Of a shard as for_each_shard gives it. Throws InputError where it is not a power study's.
PowerResult result_of(StudyShard shard) {
  try {
    PowerResult result;
    result.question = power_question_from(shard.question);
    if (!fits(result.question, shard.protocol)) throw std::invalid_argument("a question of another protocol");
    result.tally = power_tally_from(shard.result, result.question);
    result.protocol = std::move(shard.protocol);
    if (result.tally.studies == shard.range.last - shard.range.first) return result;
  } catch (const nlohmann::json::exception&) {
  } catch (const std::invalid_argument&) {
  }
  throw InputError(fmt::format("shard {} of {}: is not one of a power study (make it again)", shard.number, shard.of));
}

}  // namespace

StudyShard power_shard(const Protocol& protocol, const PowerQuestion& question, int number, int of) {
  return empty_shard(ShardKind::power, protocol, to_json(question), number, of);
}

ShardWork power_work(const Protocol& protocol, const PowerQuestion& question, int threads) {
  return {[&, threads](StudyRange range, const std::function<void(std::int64_t)>& progress) {
            return to_json(power_study(protocol, question, range, threads, progress));
          },
          [&](ordered_json& result, const ordered_json& more) {
            PowerTally tally = power_tally_from(result, question);
            tally += power_tally_from(more, question);
            result = to_json(tally);
          }};
}

PowerResult combined_power(std::span<const std::filesystem::path> files) {
  std::optional<PowerResult> all;
  for_each_shard(files, [&](StudyShard shard) {
    PowerResult one = result_of(std::move(shard));
    if (all)
      all->tally += one.tally;
    else
      all = std::move(one);
  });
  return std::move(all).value();
}

}  // namespace jnd
