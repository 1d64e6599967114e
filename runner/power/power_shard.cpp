#include "runner/power/power_shard.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <optional>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "data/files/draft.h"
#include "protocols/input/input_error.h"
#include "protocols/input/sha256.h"
#include "protocols/reading/protocol_json.h"
#include "protocols/version.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

using nlohmann::ordered_json;

constexpr std::string_view kFormat = "jnd power shard 1";

std::string name_of(const std::filesystem::path& file) {
  return printable(file.string());
}

std::filesystem::path part_of(const std::filesystem::path& file) {
  return file.string() + ".part";
}

void write_whole(const std::filesystem::path& file, const std::string& text) {
  Draft draft(file, Draft::What::file, Draft::Access::everyone);
  draft.write(text);
  draft.replace([](const std::filesystem::path&) {});
}

// What was done of the same shard before; none where there is nothing that can be used.
std::optional<PowerShard> begun(const std::filesystem::path& part, const PowerShard& whole) {
  if (!std::filesystem::exists(part)) return std::nullopt;
  try {
    PowerShard shard = read_shard(part);
    const bool same = shard.program == whole.program && shard.result.protocol.sha256 == whole.result.protocol.sha256 &&
                      to_json(shard.result.question) == to_json(whole.result.question) &&
                      shard.number == whole.number && shard.of == whole.of && shard.range.first == whole.range.first;
    return same ? std::optional(std::move(shard)) : std::nullopt;
  } catch (const InputError&) {
    return std::nullopt;  // half written: it begins anew
  }
}

// What the second differs in from the first; empty where they are of one study.
std::string difference(const PowerShard& first, const PowerShard& second) {
  if (first.program != second.program)
    return fmt::format("of version {} of the program, and the first of {}", second.program, first.program);
  if (first.result.protocol.sha256 != second.result.protocol.sha256) return "of another protocol than the first";
  const ordered_json asked = to_json(first.result.question), other = to_json(second.result.question);
  for (const auto& [key, value] : asked.items())
    if (other.at(key) != value)
      return fmt::format("of another question than the first: {} is {} and not {}", key, other.at(key).dump(),
                         value.dump());
  if (first.of != second.of) return fmt::format("one of {} shards, and the first one of {}", second.of, first.of);
  return "";
}

}  // namespace

std::string shard_text(const PowerShard& shard) {
  ordered_json json = {{"format", kFormat},
                       {"program", shard.program},
                       {"protocol", shard.result.protocol.name},
                       {"protocol_sha256", shard.result.protocol.sha256},
                       {"protocol_bytes", shard.result.protocol.bytes},
                       {"question", to_json(shard.result.question)},
                       {"shard", shard.number},
                       {"shards", shard.of},
                       {"first", shard.range.first},
                       {"last", shard.range.last},
                       {"tally", to_json(shard.result.tally)}};
  json["sha256"] = sha256_hex(json.dump());
  return json.dump(1) + "\n";
}

PowerShard read_shard(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    throw InputError(fmt::format("{}: cannot be read (give the files that --to has written)", name_of(file)));
  std::ostringstream text;
  text << stream.rdbuf();
  const auto no_shard = [&] {
    return InputError(
        fmt::format("{}: is not a shard of a power study (give the files that --to has written)", name_of(file)));
  };
  try {
    ordered_json json = ordered_json::parse(text.str());
    if (json.at("format") != kFormat) throw no_shard();
    const auto hash = json.at("sha256").get<std::string>();
    json.erase("sha256");
    if (sha256_hex(json.dump()) != hash)
      throw InputError(fmt::format("{}: is not as it was written (make it again)", name_of(file)));
    PowerShard shard;
    json.at("program").get_to(shard.program);
    json.at("shard").get_to(shard.number);
    json.at("shards").get_to(shard.of);
    json.at("first").get_to(shard.range.first);
    json.at("last").get_to(shard.range.last);
    shard.result.question = power_question_from(json.at("question"));
    shard.result.protocol =
        parse_protocol(json.at("protocol_bytes").get<std::string>(), json.at("protocol").get<std::string>() + ".json");
    shard.result.tally = power_tally_from(json.at("tally"), shard.result.question);
    return shard;
  } catch (const nlohmann::json::exception&) {
    throw no_shard();
  } catch (const std::invalid_argument&) {
    throw no_shard();
  }
}

ShardEnd make_shard(const Protocol& protocol, const PowerQuestion& question, int number, int of,
                    const std::filesystem::path& file, int threads, const std::function<void(std::int64_t)>& progress) {
  constexpr double kBetweenWrites_s = 10;
  PowerShard shard{{protocol, question, PowerTally::of(question)},
                   std::string(kVersion),
                   number,
                   of,
                   shard_range(question.studies, number, of)};
  const StudyRange all = shard.range;
  if (std::filesystem::exists(file)) {
    const PowerShard there = read_shard(file);
    const std::string other = difference(shard, there);
    if (!other.empty() || there.number != number)
      throw InputError(fmt::format("{}: is there already, and {} (give another name)", name_of(file),
                                   other.empty() ? fmt::format("is shard {}", there.number) : "is " + other));
    return ShardEnd::was_there;
  }
  const std::filesystem::path part = part_of(file);
  if (std::optional<PowerShard> before = begun(part, shard))
    shard = std::move(*before);
  else
    shard.range.last = shard.range.first;
  std::int64_t next = 1;  // studies until the next file
  while (shard.range.last < all.last) {
    const auto begin = std::chrono::steady_clock::now();
    const StudyRange range{shard.range.last, std::min(all.last, shard.range.last + next)};
    shard.result.tally += power_study(protocol, question, range, threads, [&](std::int64_t done) {
      if (progress) progress(range.first - all.first + done);
    });
    shard.range.last = range.last;
    const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (range.last < all.last && (took > kBetweenWrites_s / 2 || next > 1)) write_whole(part, shard_text(shard));
    next = std::max<std::int64_t>(
        1, took > kBetweenWrites_s / 4 ? static_cast<std::int64_t>(static_cast<double>(next) * kBetweenWrites_s / took)
                                       : next * 4);
  }
  write_whole(file, shard_text(shard));
  std::error_code ignored;
  std::filesystem::remove(part, ignored);
  return ShardEnd::made;
}

PowerResult combined(std::span<const std::filesystem::path> files) {
  std::vector<PowerShard> shards;
  std::vector<std::string> names;  // by shard
  for (const std::filesystem::path& file : files) {
    PowerShard shard = read_shard(file);
    if (!shards.empty())
      if (const std::string other = difference(shards.front(), shard); !other.empty())
        throw InputError(fmt::format("{}: is {} (combine the shards of one study)", name_of(file), other));
    const StudyRange whole = shard_range(shard.result.question.studies, shard.number, shard.of);
    if (shard.number < 1 || shard.number > shard.of || shard.range.first != whole.first ||
        shard.range.last != whole.last || shard.result.tally.studies != whole.last - whole.first)
      throw InputError(fmt::format("{}: is not a finished shard (run the command that makes it again)", name_of(file)));
    names.resize(static_cast<std::size_t>(shard.of));
    std::string& name = names[static_cast<std::size_t>(shard.number - 1)];
    if (!name.empty())
      throw InputError(
          fmt::format("{}: is shard {}, and so is {} (give one of them)", name_of(file), shard.number, name));
    name = name_of(file);
    shards.push_back(std::move(shard));
  }
  std::string missing;
  int count = 0;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i].empty() && ++count <= 10) missing += fmt::format("{}{}", missing.empty() ? "" : ", ", i + 1);
  if (count > 10) missing += fmt::format(" and {} more", count - 10);
  if (count > 0)
    throw InputError(fmt::format("shard{} {} of {} {} missing (make {}, or give {})", count == 1 ? "" : "s", missing,
                                 names.size(), count == 1 ? "is" : "are", count == 1 ? "it" : "them",
                                 count == 1 ? "its file" : "their files"));
  PowerResult result = std::move(shards.front().result);
  for (std::size_t i = 1; i < shards.size(); ++i) result.tally += shards[i].result.tally;
  return result;
}

}  // namespace jnd
