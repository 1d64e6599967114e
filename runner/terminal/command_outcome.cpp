#include "runner/terminal/command_outcome.h"

#include <cstdio>
#include <filesystem>
#include <new>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "analysis/numerics/stop_request.h"
#include "data/log/storage_error.h"
#include "devices/device_error.h"
#include "protocols/input/file_trouble.h"
#include "protocols/input/input_error.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/standard_streams.h"

namespace jnd {

namespace {

int failed(int code, const std::string& message) {
  write_marked_message(message);
  return code;
}

// Of an exception without words for users.
int failed_otherwise(const std::exception& error) {
  return failed(exit_code::kStorage,
                fmt::format("{} (an error that this command does not foresee: the studies it read are as they were; "
                            "try again, and report it with the command's words if it stays)",
                            error.what()));
}

// lost_because: why standard output takes no more, where that ended the command.
int code_of(const std::function<int()>& command, std::string& lost_because) {
  try {
    return command();
  } catch (const UsageError& error) {
    return failed(exit_code::kUsage, error.what());
  } catch (const DeviceError& error) {
    return failed(exit_code::kDevice, error.what());
  } catch (const InputError& error) {
    return failed(exit_code::kInvalidInput, error.what());
  } catch (const BrokenChain& error) {
    return failed(exit_code::kProblemFound, error.what());
  } catch (const StorageError& error) {
    return failed(exit_code::kStorage, error.what());
  } catch (const Stopped&) {
    return failed(exit_code::kInterrupted, "interrupted; nothing was left half done");
  } catch (const std::bad_alloc&) {
    return failed(exit_code::kStorage,
                  "the memory is not enough for this: nothing was left half done. Close other programs, or ask for "
                  "less at a time (a smaller file, fewer replicates, participants or threads)");
  } catch (const std::filesystem::filesystem_error& error) {
    return failed(exit_code::kStorage,
                  fmt::format("{}: cannot be opened or written: {}", error.path1().string(),
                              file_trouble(error.path1(), error.code().value(), FileUse::write).text()));
  } catch (const std::system_error& error) {
    if (std::ferror(stdout) == 0) return failed_otherwise(error);
    lost_because = error.code().message();
    return exit_code::kDone;
  } catch (const std::exception& error) {
    return failed_otherwise(error);
  } catch (...) {
    return failed(exit_code::kStorage, "an unknown error");
  }
}

// A command that was done before the signal could stop it says so; one that stopped has said so itself.
int after_signals(int code) {
  if (code != exit_code::kDone || !stop_requested()) return code;
  return failed(exit_code::kInterrupted, "interrupted when it was already done: all of it stands");
}

int after_output(int code, const std::string& lost_because) {
  std::string trouble = output_trouble();
  if (trouble.empty()) return code;
  if (!lost_because.empty()) trouble = lost_because;
  write_marked_message(
      fmt::format("what this command prints could not be written in full: {}. Files that it wrote are whole; give its "
                  "output another place and run it again",
                  trouble));
  return code == exit_code::kDone ? exit_code::kStorage : code;
}

}  // namespace

int outcome_of(const std::function<int()>& command) noexcept {
  try {
    std::string lost_because;
    const int code = after_signals(code_of(command, lost_because));
    return after_output(code, lost_because);
  } catch (...) {  // no memory for the words
    write_message("jnd: the memory is not enough even to say what happened\n");
    return exit_code::kStorage;
  }
}

}  // namespace jnd
