// Sockets of reports: who may connect, what is left alone, what is said.
#include "devices/hid/socket/local_socket.h"

#include <fstream>

#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "devices/device_error.h"
#include "devices/machine/peer_user.h"
#include "tests/catch.h"
#include "tests/temporary_folder.h"
#include "tests/text_checks.h"

using namespace jnd;

namespace {

constexpr uid_t kOtherUser = 65534;

template <typename Act>
std::string device_error_of(const Act& act) {
  try {
    act();
  } catch (const DeviceError& error) {
    return error.what();
  }
  return "none";
}

// Does it as another user; false where this login may not.
template <typename Act>
bool as_other_user(const Act& act) {
  if (geteuid() != 0 || seteuid(kOtherUser) != 0) return false;
  act();
  REQUIRE(seteuid(0) == 0);
  return true;
}

}  // namespace

TEST_CASE("a socket that is served can be connected to, by its user alone", "[local_socket]") {
  const TemporaryFolder folder;
  const OwnedFile listening = listen_local(folder / "a.sock");
  struct stat what {};
  REQUIRE(stat((folder / "a.sock").c_str(), &what) == 0);
  CHECK((what.st_mode & 0777U) == 0600U);
  CHECK(accept_local(listening).get() < 0);  // nobody yet, and it does not wait
  const OwnedFile host = connect_local(folder / "a.sock");
  const OwnedFile device = accept_local(listening);
  REQUIRE(device.get() >= 0);
  CHECK(is_same_user(host.get()));
  CHECK(is_same_user(device.get()));
  CHECK(send(host.get(), "abc", 3, MSG_NOSIGNAL) == 3);
  char bytes[8] = {};
  CHECK(recv(device.get(), bytes, sizeof bytes, 0) == 3);
}

TEST_CASE("what cannot be connected to is said, with what to do", "[local_socket]") {
  const TemporaryFolder folder;
  const auto connecting = [&](const std::string& name) {
    return device_error_of([&] { (void)connect_local(folder / name); });
  };
  CHECK(contains(connecting("none.sock"), "no device is served at " + (folder / "none.sock").string()));
  { const OwnedFile served_once = listen_local(folder / "left.sock"); }
  CHECK(contains(connecting("left.sock"), "start the program that serves it"));
  std::ofstream(folder / "file") << "text";
  CHECK(contains(connecting("file"), (folder / "file").string()));
  CHECK(contains(connecting(std::string(200, 'x')), "give one of 1 to 107"));
  CHECK(contains(device_error_of([] { (void)connect_local(""); }), "give one of 1 to 107"));
}

TEST_CASE("a socket that was left over is replaced; one in use, and any other file, is not", "[local_socket]") {
  const TemporaryFolder folder;
  { const OwnedFile served_once = listen_local(folder / "a.sock"); }
  const OwnedFile listening = listen_local(folder / "a.sock");
  CHECK(contains(device_error_of([&] { (void)listen_local(folder / "a.sock"); }), "is there already"));
  CHECK(connect_local(folder / "a.sock").get() >= 0);
  std::ofstream(folder / "file") << "text";
  CHECK(contains(device_error_of([&] { (void)listen_local(folder / "file"); }), "is there already"));
  CHECK(std::filesystem::file_size(folder / "file") == 4);
  CHECK(contains(device_error_of([&] { (void)listen_local(folder / "no/such/folder.sock"); }), "cannot serve"));
}

TEST_CASE("another user's program is refused on either side", "[local_socket]") {
  const TemporaryFolder folder;
  REQUIRE(chmod(folder.path().c_str(), 0777) == 0);
  OwnedFile theirs;
  if (!as_other_user([&] { theirs = listen_local(folder / "theirs.sock"); })) {
    WARN("only root can try this");
    return;
  }
  CHECK(contains(device_error_of([&] { (void)connect_local(folder / "theirs.sock"); }), "served by another user"));
  const OwnedFile ours = listen_local(folder / "ours.sock");
  std::string refused;
  as_other_user([&] { refused = device_error_of([&] { (void)connect_local(folder / "ours.sock"); }); });
  CHECK(contains(refused, "this login may not use"));
  // Where the file's rights let it in all the same, it is sent away.
  REQUIRE(chmod((folder / "ours.sock").c_str(), 0666) == 0);
  as_other_user([&] { (void)device_error_of([&] { (void)connect_local(folder / "ours.sock"); }); });
  CHECK(accept_local(ours).get() < 0);
}
