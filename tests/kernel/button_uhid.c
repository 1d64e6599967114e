// A button box behind /dev/uhid whose participant does as told: reads what jnd says from standard input, line by line,
// presses and lets go, and writes the operator's keys to standard output.
//   button_uhid pedal|gamepad|keyboard [troubled]
// pedal: one byte, on change. gamepad: numbered reports every 8 ms, with axes that jitter. keyboard: boot reports.
#include <errno.h>
#include <fcntl.h>
#include <linux/input.h>
#include <linux/uhid.h>
#include <poll.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { SAME = 1, DIFFERENT = 2, STOP = 4 };

static const uint8_t pedal_descriptor[] = {0x05, 0x0c, 0x09, 0x03, 0xa1, 0x01, 0x05, 0x09, 0x19, 0x01, 0x29, 0x08,
                                           0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x08, 0x81, 0x02, 0xc0};
static const uint8_t gamepad_descriptor[] = {
    0x05, 0x01, 0x09, 0x05, 0xa1, 0x01, 0x85, 0x03, 0x09, 0x30, 0x09, 0x31, 0x15, 0x00, 0x26, 0xff, 0x00, 0x75, 0x08,
    0x95, 0x02, 0x81, 0x02, 0x05, 0x09, 0x19, 0x01, 0x29, 0x08, 0x25, 0x01, 0x75, 0x01, 0x95, 0x08, 0x81, 0x02, 0xc0};
static const uint8_t keyboard_descriptor[] = {0x05, 0x01, 0x09, 0x06, 0xa1, 0x01, 0x05, 0x07, 0x19, 0xe0, 0x29, 0xe7,
                                              0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x08, 0x81, 0x02, 0x95, 0x01,
                                              0x75, 0x08, 0x81, 0x01, 0x95, 0x06, 0x75, 0x08, 0x15, 0x00, 0x26, 0xff,
                                              0x00, 0x19, 0x00, 0x2a, 0xff, 0x00, 0x81, 0x00, 0xc0};

static int uhid = -1;
static const char* kind;
static bool there;
static unsigned down;  // SAME | DIFFERENT | STOP

static void send_event(const struct uhid_event* event) {
  if (write(uhid, event, sizeof *event) != (ssize_t)sizeof *event) {
    perror("button_uhid");
    exit(1);
  }
}

static void create(void) {
  const uint8_t* descriptor = pedal_descriptor;
  size_t size = sizeof pedal_descriptor;
  if (kind[0] == 'g') descriptor = gamepad_descriptor, size = sizeof gamepad_descriptor;
  if (kind[0] == 'k') descriptor = keyboard_descriptor, size = sizeof keyboard_descriptor;
  struct uhid_event event = {.type = UHID_CREATE2};
  snprintf((char*)event.u.create2.name, sizeof event.u.create2.name, "Test %s", kind);
  memcpy(event.u.create2.rd_data, descriptor, size);
  event.u.create2.rd_size = (uint16_t)size;
  event.u.create2.bus = BUS_USB;
  event.u.create2.vendor = 0x1209;
  event.u.create2.product = 0x5b00;
  send_event(&event);
  there = true;
}

static void report(void) {
  struct uhid_event event = {.type = UHID_INPUT2};
  uint8_t* data = event.u.input2.data;
  if (kind[0] == 'g') {
    const uint8_t bytes[] = {3, (uint8_t)(128 + rand() % 3), (uint8_t)(127 + rand() % 2), (uint8_t)(down << 2)};
    memcpy(data, bytes, event.u.input2.size = sizeof bytes);
  } else if (kind[0] == 'k') {
    int place = 2;
    if ((down & DIFFERENT) != 0) data[place++] = 31;
    if ((down & SAME) != 0) data[place++] = 30;
    if ((down & STOP) != 0) data[place++] = 41;
    event.u.input2.size = 8;
  } else {
    data[0] = (uint8_t)down;
    event.u.input2.size = 1;
  }
  send_event(&event);
}

static void set(unsigned buttons) {
  down = buttons;
  report();
}

// Waits, while the device does what such a device does.
static void run_ms(int milliseconds) {
  for (int past = 0; past < milliseconds; past += 8) {
    if (kind[0] == 'g' && there) report();
    nanosleep(&(struct timespec){0, 8000000}, NULL);
  }
}

static void keys(const char* text) {
  if (write(STDOUT_FILENO, text, strlen(text)) < 0) exit(0);
}

static void destroy(void) {
  struct uhid_event event = {.type = UHID_DESTROY};
  send_event(&event);
  there = false;
}

static int questions;

// The first three questions of a troubled session: both buttons and then one; stop; unplugged.
static void answer(bool troubled) {
  ++questions;
  run_ms(400);
  if (troubled && questions == 1) {
    set(SAME | DIFFERENT);
    run_ms(300);
    set(0);
    run_ms(300);
  } else if (troubled && questions == 2) {
    set(STOP);
    run_ms(80);
    set(0);
    return;
  } else if (troubled && questions == 3) {
    destroy();
    run_ms(600);
    keys("d");
    create();
    return;
  }
  set(questions % 2 == 0 ? SAME : DIFFERENT);
  run_ms(80);
  set(0);
}

static void obey(const char* line, bool troubled) {
  if (strstr(line, "hold it.") != NULL) {
    run_ms(300);
    set(strstr(line, "SAME") ? SAME : strstr(line, "DIFFERENT") ? DIFFERENT : STOP);
  } else if (strcmp(line, "Let go.") == 0) {
    run_ms(200);
    set(0);
  } else if (strncmp(line, "Trial ", 6) == 0) {
    run_ms(questions == 3 ? 1500 : 0);  // until the box is found again
    keys(" ");
  } else if (strncmp(line, "STOPPED", 7) == 0) {
    keys("cfoot slipped\n");
  } else if (strstr(line, "Same or different?") != NULL) {
    answer(troubled);
  }
}

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  kind = argv[1];
  uhid = open("/dev/uhid", O_RDWR | O_CLOEXEC);
  if (uhid < 0) {
    perror("/dev/uhid");
    return 1;
  }
  create();
  char line[512];
  size_t length = 0;
  for (;;) {
    struct pollfd waits[2] = {{STDIN_FILENO, POLLIN, 0}, {uhid, POLLIN, 0}};
    poll(waits, 2, 8);
    if (waits[1].revents & POLLIN) {
      struct uhid_event event;
      if (read(uhid, &event, sizeof event) < 0) return 1;
    }
    if (kind[0] == 'g') report();
    if ((waits[0].revents & (POLLIN | POLLHUP)) == 0) continue;
    char character = 0;
    if (read(STDIN_FILENO, &character, 1) != 1) return 0;
    if (character != '\n') {
      if (length < sizeof line - 1) line[length++] = character;
      continue;
    }
    line[length] = 0;
    length = 0;
    obey(line, argc > 2);
  }
}
