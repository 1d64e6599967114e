// Files that a user names: whatever they are, reading them ends, and within bounds.
#include "protocols/input/read_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/protocols/rigs.h"

using namespace jnd;
using namespace jnd::test;

TEST_CASE("what is no file is refused with what it is, and nobody is waited for") {
  const TemporaryFolder folder;
  const std::filesystem::path pipe = folder.write("beside", "").parent_path() / "pipe";
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  CHECK_THROWS_WITH(read_input_file(pipe), Catch::Contains("named pipe") && Catch::Contains("into a file"));
  CHECK_THROWS_WITH(read_input_file("/dev/zero"), Catch::Contains("is a device, not a file"));
  CHECK_THROWS_WITH(read_input_file(pipe.parent_path()), Catch::Contains("is a folder (name a file in it)"));
  CHECK_THROWS_WITH(read_input_file(folder.write("file", "") / "below"), Catch::Contains("cannot be opened"));
}

TEST_CASE("a file may be as long as the limit and no longer") {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.write("file", std::string(100'000, 'x'));
  CHECK(read_input_file(file).size() == 100'000);
  CHECK(read_input_file(file, 100'000).size() == 100'000);
  CHECK_THROWS_WITH(read_input_file(file, 99'999), Catch::Contains("is larger than 99999 bytes"));
  CHECK_THROWS_WITH(read_input_file(folder.write("large", std::string(kMostInputBytes + 1, 'x'))),
                    Catch::Contains("is larger than 1 MiB"));
}

TEST_CASE("a shell's <(command) is read to its end") {
  int ends[2];
  REQUIRE(pipe(ends) == 0);
  REQUIRE(write(ends[1], "abc", 3) == 3);
  close(ends[1]);
  CHECK(read_input_file(fmt::format("/dev/fd/{}", ends[0])) == "abc");
  close(ends[0]);
}
