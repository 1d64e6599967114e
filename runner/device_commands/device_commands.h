// `jnd device`: what the devices and their models do, before a study relies on them.
// runner/device_commands/device_commands.cpp turns arguments into these options; each command is a function in a
// command_device_*.cpp of its own.
//
// Each returns the exit code and prints to stdout. They throw InputError, DeviceError and UsageError. Angles are rad,
// everything else SI.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "protocols/rigs/device_spec.h"
#include "protocols/vocabulary.h"

namespace CLI {
class App;
}

namespace jnd {

// Adds the whole tree. chosen becomes the command that the arguments name.
void add_device_commands(CLI::App& app, std::function<int()>& chosen);

// Where an answer goes beside the text for a person. csv: a file to write, "-" for standard output (then nothing else
// is printed there), empty for none.
struct DeviceOutput {
  bool json = false;
  std::string csv;
};

int command_device_list(bool json);
int command_device_info(const std::string& name, bool json);

struct Rrs3ModelOptions {
  std::string pose;      // "PZ,ROLL,PITCH"
  std::string geometry;  // a file; empty: the shipped device
  std::string wrench;    // "FX,FY,FZ,MX,MY,MZ"; empty: none
  double stiffness_n_per_m = 0;
  std::optional<double> rotational_n_m_per_rad;  // where not given, the stiffness in N mm/rad
  std::string batch;                             // a file of JSON lines, "-": standard input
  bool map = false;
  std::optional<double> height_m;  // of the map; the rest height where not given
  DeviceOutput output;
};
int command_device_model_rrs3(const Rrs3ModelOptions& options);
// The model's answers to a file of JSON lines; part of the above.
int answer_rrs3_batch(const Rrs3ModelOptions& options);

struct MckibbenModelOptions {
  std::string spec = "mckibben";
  std::optional<double> angle_rad;
  std::optional<double> pressure_pa, length_m;   // gauge, of the muscle
  std::optional<double> upstream_pa, muscle_pa;  // absolute
  bool sweep = false;                            // over the usable range
  DeviceOutput output;
};
int command_device_model_mckibben(const MckibbenModelOptions& options);

// The force loop of a McKibben finger.
struct MckibbenLoopOptions {
  std::string spec = "mckibben";
  ForceGains gains{.kp = 0.28};  // the paper's
  Tendon tendon = Tendon::bilateral;
};

struct DeviceStepOptions {
  MckibbenLoopOptions loop;
  std::optional<double> angle_rad;  // straight where not given
  double from_n = 0, to_n = 5;
  double duration_s = 1.2;
  DeviceOutput output;
};
int command_device_step(const DeviceStepOptions& options);

struct DeviceBodeOptions {
  MckibbenLoopOptions loop;
  std::optional<double> angle_rad;
  double mean_n = 10, amplitude_n = 8;
  std::vector<double> frequencies_rad_per_s;
  int settle_cycles = 6, measure_cycles = 3;
  DeviceOutput output;
};
int command_device_bode(const DeviceBodeOptions& options);

struct DeviceTrackOptions {
  MckibbenLoopOptions loop;
  std::vector<double> kobj_n_per_rad;
  double frequency_hz = 0.5;
  DeviceOutput output;
};
int command_device_track(const DeviceTrackOptions& options);

struct DeviceOnsetOptions {
  std::string spec = "mckibben";
  std::vector<double> angles_rad;  // some from straight to flexed where empty
  DeviceOutput output;
};
int command_device_onset(const DeviceOnsetOptions& options);

struct Rrs3StiffnessOptions {
  std::string spec = "rrs3";
  std::vector<double> stiffness_n_per_m;
  RenderingMode mode = RenderingMode::wrench;
  double finger_n_per_m = 1000;
  double roll_rad = 0, pitch_rad = 0;
  DeviceOutput output;
};
int command_device_stiffness_rrs3(const Rrs3StiffnessOptions& options);

struct MckibbenStiffnessOptions {
  std::string spec = "mckibben";
  std::vector<double> stiffness_n_per_rad;
  std::optional<double> kp, ki, kd;  // where none is given: the paper's P, and the device's own control
  std::optional<Tendon> tendon;      // the device's own where not given
  double frequency_hz = 0.5;
  DeviceOutput output;
};
int command_device_stiffness_mckibben(const MckibbenStiffnessOptions& options);

// Of a rig, or of a real device by serial number or path. yes: a real device may press without asking.
int command_device_test(const std::string& name, bool json, bool yes = false);

struct DeviceCalibrateOptions {
  std::string name;                       // serial number or path
  std::string reference = "interactive";  // or a CSV file: known_n, and pushed_n where the device presses the reference
  std::vector<double> push_n;             // forces to press the reference with, each read from it and typed
  std::string operator_name, reference_name, remarks;
  std::string out;  // of the certificate; named by serial, date and id in this folder where empty
  bool no_stiffness = false, store = false, yes = false, json = false;
};
int command_device_calibrate(const DeviceCalibrateOptions& options);

struct LearnButtonsOptions {
  std::string file;    // to write; it must not exist
  std::string device;  // path, such as "/dev/hidraw0"; empty: the only one, or asked for
  bool with_stop = false;
  int debounce_ms = 10;
};
int command_device_learn_buttons(const LearnButtonsOptions& options);

struct DoctorOptions {
  std::optional<std::string> study;  // a study, or the folder where studies go; where not given, this folder
  double seconds = 3;                // of each measurement of the loop's lateness
  std::string protocol, rig;         // to be fit for: a protocol's file or shipped name, a rig file; empty: none
  bool json = false;
};
int command_doctor(const DoctorOptions& options);

}  // namespace jnd
