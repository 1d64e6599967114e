#include "devices/hid/hidapi_bus.h"

#include <bit>
#include <cerrno>
#include <cstring>
#include <cwchar>
#include <mutex>

#include <fcntl.h>
#include <fmt/format.h>
#include <hidapi.h>
#include <linux/hidraw.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "devices/device_error.h"
#include "protocols/input/utf8.h"

namespace jnd {

namespace {

// hid_init, hid_enumerate, hid_open_path, hid_close and hid_error(NULL) share one string of hidapi's.
std::mutex& hidapi_mutex() {
  static std::mutex mutex;
  return mutex;
}

// Whatever the locale: the names of devices come as UTF-32.
std::string utf8(const wchar_t* text) {
  std::string out;
  for (; text != nullptr && *text != 0; ++text) out += to_utf8(std::bit_cast<char32_t>(*text));
  return out;
}

class HidapiHandle final : public HidHandle {
 public:
  explicit HidapiHandle(hid_device* device) noexcept : device_(device) {}
  ~HidapiHandle() override {
    const std::lock_guard lock(hidapi_mutex());
    hid_close(device_);
  }
  HidapiHandle(const HidapiHandle&) = delete;
  HidapiHandle& operator=(const HidapiHandle&) = delete;

  int read(std::span<std::uint8_t> bytes, int timeout_ms) noexcept override {
    const int count = hid_read_timeout(device_, bytes.data(), bytes.size(), timeout_ms);
    return count < 0 ? kHidGone : count;
  }

  // hidraw takes a shorter report than the device's as one, so whether all was taken is looked at here.
  bool write(std::span<const std::uint8_t> bytes) noexcept override {
    return hid_write(device_, bytes.data(), bytes.size()) == static_cast<int>(bytes.size());
  }

  std::string error() const override { return utf8(hid_error(device_)); }

 private:
  hid_device* device_;
};

DeviceError cannot_open(const std::string& path, const std::string& why) {
  return DeviceError(fmt::format("{} cannot be opened: {}; connect the device again", path, why));
}

// Asks the node itself whether it is a HID device that is there, and stays open meanwhile. hidapi up to 0.13.1 uses
// memory that it has freed when a path opens but does not answer as hidraw does (hidapi issue 542), as of a device that
// is being unplugged: it must be asked for good paths only.
class HidrawNode {
 public:
  explicit HidrawNode(const std::string& path) : file_(open(path.c_str(), O_RDWR | O_CLOEXEC)) {
    if (file_ < 0) {
      const int error = errno;
      if (error == EACCES || error == EPERM)
        throw DeviceError(
            fmt::format("this login may not use {} ({}): install the udev rule devices/hid/70-jnd.rules as "
                        "/etc/udev/rules.d/70-jnd.rules, run \"sudo udevadm control --reload\" and connect the device "
                        "again",
                        path, std::strerror(error)));
      throw cannot_open(path, std::strerror(error));
    }
    int bytes = 0;
    if (ioctl(file_, HIDIOCGRDESCSIZE, &bytes) < 0) {
      const int error = errno;
      close(file_);
      throw cannot_open(path, error == ENOTTY ? "it is no HID device" : std::strerror(error));
    }
  }
  ~HidrawNode() { close(file_); }
  HidrawNode(const HidrawNode&) = delete;
  HidrawNode& operator=(const HidrawNode&) = delete;

 private:
  int file_;
};

}  // namespace

HidapiBus::HidapiBus() {
  const std::lock_guard lock(hidapi_mutex());
  if (hid_init() != 0)
    throw DeviceError(
        fmt::format("hidapi cannot begin: {}; reinstall the package libhidapi-hidraw0", utf8(hid_error(nullptr))));
}

std::vector<HidInfo> HidapiBus::list() {
  const std::lock_guard lock(hidapi_mutex());
  hid_device_info* const first = hid_enumerate(0, 0);
  std::vector<HidInfo> found;
  for (const hid_device_info* at = first; at != nullptr; at = at->next) {
    HidInfo info;
    info.path = at->path != nullptr ? at->path : "";
    info.vendor = at->vendor_id;
    info.product = at->product_id;
    info.usage_page = at->usage_page;
    info.usage = at->usage;
    info.serial = utf8(at->serial_number);
    info.manufacturer = utf8(at->manufacturer_string);
    info.product_name = utf8(at->product_string);
    info.interface_number = at->interface_number;
    found.push_back(std::move(info));
  }
  hid_free_enumeration(first);
  return found;
}

std::unique_ptr<HidHandle> HidapiBus::open(const std::string& path) {
  const HidrawNode node(path);
  const std::lock_guard lock(hidapi_mutex());
  if (hid_device* const device = hid_open_path(path.c_str())) return std::make_unique<HidapiHandle>(device);
  throw cannot_open(path, utf8(hid_error(nullptr)));
}

}  // namespace jnd
