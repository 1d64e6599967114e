// Reading and writing the pages of a device of ours over an open handle: what it is, what it can do, how it was
// calibrated. For handshakes and commands: it waits for each answer, so never in the loop.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "devices/hid/firmware/jnd_report.h"
#include "devices/hid/hid_bus.h"

namespace jnd {

using PageData = std::array<std::uint8_t, JND_PAGE_SIZE>;

// How long to wait for an answer, and how often to ask. A device answers within a few steps of its loop; only writing
// into a memory that must be erased first takes longer.
struct PagePatience {
  int read_ms = 300;
  int write_ms = 2000;
  int tries = 3;
};

// Everything throws DeviceError, with the device, the page, what happened and what to do: the device is gone, does not
// answer, speaks another version of the protocol, refuses, or answers what the protocol does not allow.
// Thread rule: the handle's thread.
class PageExchange {
 public:
  using Listener = std::function<void(std::span<const std::uint8_t>)>;

  // device: what messages call it, such as a serial number or a path. others: gets every report that came instead of
  // an answer, whole and in order; may be empty. The handle must outlive this.
  PageExchange(HidHandle& handle, std::string device, Listener others = {}, PagePatience patience = {});

  // Refused where the device does not speak JND_PROTOCOL_VERSION: both ranges are then in the message.
  jnd_identity identity();
  jnd_limits limits();
  jnd_geometry geometry();
  jnd_force_table force_table();
  jnd_certificate certificate();

  // Written, read back and compared.
  void store(const jnd_force_table& table);
  void store(const jnd_certificate& certificate);

  PageData read(jnd_page_number page);
  void write(jnd_page_number page, const PageData& data);

 private:
  PageData ask(jnd_operation operation, jnd_page_number page, const PageData& data, int wait_ms);
  bool take_answer(const jnd_request& request, int wait_ms, jnd_answer& answer);
  void drain();
  int read_report(std::span<std::uint8_t> bytes, int wait_ms);
  void store(jnd_page_number page, const PageData& data);

  HidHandle& handle_;
  std::string device_;
  Listener others_;
  PagePatience patience_;
  std::uint32_t token_;
  int other_version_ = 0;  // of an answer that was none of ours; 0: none
};

}  // namespace jnd
