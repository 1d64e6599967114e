// What a command throws, as words and exit codes; output that cannot be written.
#include "runner/terminal/command_outcome.h"

#include <cerrno>
#include <cstdio>
#include <new>
#include <stdexcept>

#include <fcntl.h>
#include <unistd.h>

#include "analysis/numerics/stop_request.h"
#include "data/log/storage_error.h"
#include "protocols/input/input_error.h"
#include "runner/terminal/exit_code.h"
#include "tests/catch.h"

using namespace jnd;

namespace {

// A standard stream that goes to another file for as long as this lives.
class Redirected {
 public:
  Redirected(std::FILE* stream, int descriptor) : stream_(stream), saved_(dup(fileno(stream))) {
    std::fflush(stream_);
    dup2(descriptor, fileno(stream_));
  }
  ~Redirected() {
    std::fflush(stream_);
    std::clearerr(stream_);
    dup2(saved_, fileno(stream_));
    close(saved_);
  }
  Redirected(const Redirected&) = delete;
  Redirected& operator=(const Redirected&) = delete;

 private:
  std::FILE* stream_;
  int saved_;
};

struct Outcome {
  int code = 0;
  std::string said;  // on standard error
};

Outcome outcome(const std::function<int()>& command) {
  std::FILE* said = std::tmpfile();
  REQUIRE(said != nullptr);
  Outcome result;
  {
    const Redirected to_file(stderr, fileno(said));
    result.code = outcome_of(command);
  }
  std::rewind(said);
  for (int byte = std::fgetc(said); byte != EOF; byte = std::fgetc(said)) result.said += static_cast<char>(byte);
  std::fclose(said);
  return result;
}

// As if a signal had come, for as long as this lives.
class StopRequested {
 public:
  StopRequested() { stop_requested() = true; }
  ~StopRequested() { stop_requested() = false; }
  StopRequested(const StopRequested&) = delete;
  StopRequested& operator=(const StopRequested&) = delete;
};

template <typename Error>
Outcome of(const Error& error) {
  return outcome([&]() -> int { throw error; });
}

}  // namespace

TEST_CASE("what a command throws becomes its exit code, and words with what to do") {
  CHECK(outcome([] { return 3; }).code == 3);
  CHECK(of(UsageError("two\nlines")).said == "jnd: two\njnd: lines\n");
  CHECK(of(UsageError("x")).code == exit_code::kUsage);
  CHECK(of(InputError("x")).code == exit_code::kInvalidInput);
  CHECK(of(StorageError("x")).code == exit_code::kStorage);
  const Outcome memory = of(std::bad_alloc());
  CHECK(memory.code == exit_code::kStorage);
  CHECK_THAT(memory.said, Catch::Contains("the memory is not enough") && !Catch::Contains("bad_alloc"));
  CHECK_THAT(of(std::runtime_error("no such thing")).said, Catch::Contains("no such thing (an error that"));
  const Outcome stopped = of(Stopped());
  CHECK(stopped.code == exit_code::kInterrupted);
  CHECK_THAT(stopped.said, Catch::Contains("interrupted"));
}

TEST_CASE("a signal that came too late to stop a command is said") {
  const StopRequested requested;
  const Outcome late = outcome([] { return 0; });
  CHECK(late.code == exit_code::kInterrupted);
  CHECK_THAT(late.said, Catch::Contains("already done"));
}

TEST_CASE("results that cannot be printed are not done, and messages that cannot be are lost and no more") {
  const int full = open("/dev/full", O_WRONLY | O_CLOEXEC);
  REQUIRE(full >= 0);
  Outcome lost;
  {
    const Redirected to_full(stdout, full);
    lost = outcome([] {
      std::fputs("the result\n", stdout);
      return 0;
    });
  }
  CHECK(lost.code == exit_code::kStorage);
  CHECK_THAT(lost.said, Catch::Contains("could not be written in full: No space left on device"));
  {
    const Redirected to_full(stderr, full);
    CHECK(outcome_of([]() -> int { throw InputError("nobody reads this"); }) == exit_code::kInvalidInput);
  }
  close(full);
}
