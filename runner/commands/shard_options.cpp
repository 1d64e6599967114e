#include "runner/commands/shard_options.h"

#include <charconv>
#include <optional>

#include <fmt/format.h>

#include "runner/keys/interrupt.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/progress_bar.h"
#include "runner/terminal/terminal.h"

namespace jnd {

void add_shard_options(const Command& command, ShardOptions& options, const std::string& studies) {
  const CommandOption to =
      command.add_option("--to", options.to, "write what `jnd combine` reads to this file, instead of the result");
  const CommandOption shard =
      command.add_option("--shard", options.shard, "one shard of the studies only, such as 3/64");
  to.needs(command.option(studies));
  shard.needs(to);
}

ShardPlace place_of(const ShardOptions& options) {
  const std::string& text = options.shard;
  if (text.empty()) return {};
  ShardPlace shard;
  const std::size_t slash = text.find('/');
  const auto number = [&](std::size_t begin, std::size_t end, int& value) {
    const auto [rest, error] = std::from_chars(text.data() + begin, text.data() + end, value);
    return error == std::errc() && rest == text.data() + end;
  };
  if (slash == std::string::npos || !number(0, slash, shard.number) || !number(slash + 1, text.size(), shard.of) ||
      shard.number < 1 || shard.number > shard.of || shard.of > kMostStudyShards)
    throw UsageError(fmt::format("--shard {}: K/N with K from 1 to N, such as 3/64", printable(text)));
  return shard;
}

int make_shard_file(const StudyShard& empty, const ShardWork& work, const ShardOptions& options) {
  const HoldInterrupts hold;
  const StudyRange range = empty.whole_range();
  std::optional<ProgressBar> bar(std::in_place, "simulating studies", range.last - range.first);
  const ShardEnd end = make_shard(empty, options.to, work, [&bar](std::int64_t done) { bar->update(done); });
  bar.reset();
  const std::string studies =
      range.last == range.first ? "no study" : fmt::format("studies {} to {}", range.first + 1, range.last);
  fmt::print("{}: shard {} of {}, {}{}\n", printable(options.to), empty.number, empty.of, studies,
             end == ShardEnd::was_there ? "; it was there already" : "");
  return exit_code::kDone;
}

}  // namespace jnd
