#include "devices/hid/virtual/uhid_port.h"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/uhid.h>
#include <unistd.h>

#include "devices/device_error.h"

namespace jnd {

namespace {

constexpr const char* kNode = "/dev/uhid";

std::string cannot_open(int error) {
  std::string text = fmt::format("cannot open {}: {}", kNode, std::strerror(error));
  if (error == ENOENT || error == ENODEV)
    return text +
           "; load the kernel's module with \"sudo modprobe uhid\" (a kernel without it, as in many containers, cannot "
           "have virtual devices)";
  if (error == EACCES || error == EPERM)
    return text +
           "; run as root, or let your login use it: put KERNEL==\"uhid\", GROUP=\"plugdev\", MODE=\"0660\" into "
           "/etc/udev/rules.d/70-uhid.rules, then \"sudo udevadm control --reload && sudo udevadm trigger\"";
  return text;
}

template <std::size_t size>
void put_text(std::uint8_t (&to)[size], const std::string& from) {
  std::memset(to, 0, size);
  std::memcpy(to, from.data(), std::min(from.size(), size - 1));
}

// The kernel takes the rest of a short event as zeros.
bool hand_over(int fd, const uhid_event& event, std::size_t size = sizeof(uhid_event)) noexcept {
  ssize_t written = 0;
  do {
    written = ::write(fd, &event, size);
  } while (written < 0 && errno == EINTR);
  return written == static_cast<ssize_t>(size);
}

}  // namespace

UhidPort::UhidPort() : fd_(::open(kNode, O_RDWR | O_CLOEXEC | O_NONBLOCK)) {
  if (fd_ < 0) throw DeviceError(cannot_open(errno));
}

UhidPort::~UhidPort() {
  ::close(fd_);  // the kernel unplugs what is still there
}

void UhidPort::plug(const HidDescription& description) {
  uhid_event event{};
  event.type = UHID_CREATE2;
  uhid_create2_req& request = event.u.create2;
  put_text(request.name, description.name);
  put_text(request.phys, description.phys);
  put_text(request.uniq, description.serial);
  if (description.report_descriptor.size() > sizeof request.rd_data)
    throw DeviceError("the report descriptor is longer than the kernel takes");
  std::memcpy(request.rd_data, description.report_descriptor.data(), description.report_descriptor.size());
  request.rd_size = static_cast<std::uint16_t>(description.report_descriptor.size());
  request.bus = BUS_USB;
  request.vendor = description.vendor;
  request.product = description.product;
  started_ = opened_ = false;
  if (!hand_over(fd_, event))
    throw DeviceError(fmt::format("the kernel refuses the virtual device: {}", std::strerror(errno)));
  plugged_ = true;
}

void UhidPort::unplug() {
  if (!plugged_) return;
  uhid_event event{};
  event.type = UHID_DESTROY;
  (void)hand_over(fd_, event);
  plugged_ = started_ = opened_ = false;
}

bool UhidPort::serve(const std::function<void(std::span<const std::uint8_t>)>& output) {
  uhid_event event{};
  if (::read(fd_, &event, sizeof event) <= 0) return false;
  // After a replug the events of the device that is no more come first: only START makes what follows count.
  switch (event.type) {
    case UHID_START:
      started_ = plugged_;
      break;
    case UHID_STOP:
      started_ = opened_ = false;
      break;
    case UHID_OPEN:
      opened_ = started_;
      break;
    case UHID_CLOSE:
      opened_ = false;
      break;
    case UHID_OUTPUT:
      if (started_) output({event.u.output.data, std::min<std::size_t>(event.u.output.size, UHID_DATA_MAX)});
      break;
    case UHID_GET_REPORT: {
      uhid_event reply{};
      reply.type = UHID_GET_REPORT_REPLY;
      reply.u.get_report_reply.id = event.u.get_report.id;
      reply.u.get_report_reply.err = EIO;
      (void)hand_over(fd_, reply);
      break;
    }
    case UHID_SET_REPORT: {
      uhid_event reply{};
      reply.type = UHID_SET_REPORT_REPLY;
      reply.u.set_report_reply.id = event.u.set_report.id;
      reply.u.set_report_reply.err = EIO;
      (void)hand_over(fd_, reply);
      break;
    }
    default:
      break;
  }
  return true;
}

bool UhidPort::send(std::span<const std::uint8_t> report) noexcept {
  if (!opened_) return false;
  uhid_event event;  // NOLINT(cppcoreguidelines-pro-type-member-init): only what is used of its four kilobytes
  event.type = UHID_INPUT2;
  const std::size_t size = std::min<std::size_t>(report.size(), UHID_DATA_MAX);
  std::memcpy(event.u.input2.data, report.data(), size);
  event.u.input2.size = static_cast<std::uint16_t>(size);
  return hand_over(fd_, event, offsetof(uhid_event, u.input2.data) + size);
}

}  // namespace jnd
