// The machine's identity from start to start, read from made-up trees.
#include "devices/machine/boot_id.h"

#include <fstream>

#include "devices/clock.h"
#include "tests/catch.h"

using namespace jnd;

namespace {

namespace fs = std::filesystem;

class MadeUpRoot {
 public:
  explicit MadeUpRoot(const std::string& id) {
    std::string name = (fs::temp_directory_path() / "jnd-boot-XXXXXX").string();
    root_ = mkdtemp(name.data());
    fs::create_directories(root_ / "proc/sys/kernel/random");
    std::ofstream(root_ / "proc/sys/kernel/random/boot_id") << id;
  }
  ~MadeUpRoot() { fs::remove_all(root_); }
  MadeUpRoot(const MadeUpRoot&) = delete;
  MadeUpRoot& operator=(const MadeUpRoot&) = delete;
  const fs::path& path() const noexcept { return root_; }

 private:
  fs::path root_;
};

}  // namespace

TEST_CASE("the boot id is what the kernel says, and nothing else") {
  const char* id = "0f3c8a52-7e55-4f0e-9a51-2b8d1c9e4d77";
  CHECK(boot_id(MadeUpRoot(std::string(id) + "\n").path()) == id);
  for (const char* other : {"", "\n", "unknown\n", "0f3c8a52-7e55-4f0e-9a51-2b8d1c9e4d7\x1b\n"})
    CHECK(boot_id(MadeUpRoot(other).path()).empty());
  CHECK(boot_id("/nowhere").empty());
}

TEST_CASE("this machine's boot id does not change while it runs") {
  CHECK(boot_id() == boot_id());
}

TEST_CASE("the time since the machine's start goes on, and is not behind the monotonic clock") {
  const std::int64_t first = since_boot_ns();
  const std::int64_t monotonic = SteadyClock().now_ns();
  const std::int64_t second = since_boot_ns();
  CHECK(first > 0);
  CHECK(second >= first);
  CHECK(second >= monotonic);
}
