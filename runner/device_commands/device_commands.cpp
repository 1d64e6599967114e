#include "runner/device_commands/device_commands.h"

#include <cmath>
#include <map>
#include <memory>

#include <CLI/CLI.hpp>

#include "runner/keys/interrupt.h"

namespace jnd {

namespace {

// Everything that the arguments fill in; it lives as long as the parser.
struct Arguments {
  bool json = false, yes = false;
  std::string rig;
  DeviceCalibrateOptions calibrate;
  Rrs3ModelOptions rrs3_model;
  MckibbenModelOptions mckibben_model;
  DeviceStepOptions step;
  DeviceBodeOptions bode;
  DeviceTrackOptions track;
  DeviceOnsetOptions onset;
  Rrs3StiffnessOptions rrs3_stiffness;
  MckibbenStiffnessOptions mckibben_stiffness;
  LearnButtonsOptions learn_buttons;
};

const std::map<std::string, Tendon> kTendons = {{"bilateral", Tendon::bilateral}, {"unilateral", Tendon::unilateral}};
const std::map<std::string, RenderingMode> kModes = {
    {"wrench", RenderingMode::wrench}, {"pd", RenderingMode::pd}, {"pd-literal", RenderingMode::pd_literal}};

// An option whose value is one of some words. value: T or std::optional<T>.
template <typename T, typename Value>
void add_choice(CLI::App& command, const std::string& name, Value& value, const std::map<std::string, T>& words,
                const std::string& what) {
  command
      .add_option_function<std::string>(
          name, [&value, &words](const std::string& word) { value = words.at(word); }, what)
      ->check(CLI::IsMember(words));
}

const CLI::Validator& finite() {
  static const CLI::Validator validator(
      [](std::string& text) -> std::string {
        double value = 0;
        if (!CLI::detail::lexical_cast(text, value)) return {};  // the option itself says so
        return std::isfinite(value) ? "" : "\"" + text + "\" is not a finite number";
      },
      "", "finite");
  return validator;
}

class Tree {
 public:
  Tree(CLI::App& device, std::function<int()>& chosen) : device_(device), chosen_(chosen) {}

  void add_lists();
  void add_models();
  void add_responses();
  void add_stiffnesses();
  void add_test();
  void add_calibrate();
  void add_learn_buttons();

 private:
  CLI::App* add(CLI::App& parent, const std::string& name, const std::string& what, const std::string& example,
                std::function<int()> run);
  CLI::App* group(const std::string& name, const std::string& what);
  static void add_output(CLI::App& command, DeviceOutput& output, const std::string& what_csv);
  static void add_loop(CLI::App& command, MckibbenLoopOptions& loop);
  template <typename T>
  static CLI::Option* number(CLI::App& command, const std::string& name, T& value, const std::string& what) {
    return command.add_option(name, value, what)->check(finite());
  }

  CLI::App& device_;
  std::function<int()>& chosen_;
  std::shared_ptr<Arguments> arguments_ = std::make_shared<Arguments>();
};

// A command whose help ends with an example.
CLI::App* Tree::add(CLI::App& parent, const std::string& name, const std::string& what, const std::string& example,
                    std::function<int()> run) {
  CLI::App* command = parent.add_subcommand(name, what);
  command->footer("Example:\n  jnd device " + example);
  command->callback(
      [&chosen = chosen_, keep = arguments_, run = std::move(run)] { chosen = [keep, run] { return run(); }; });
  return command;
}

CLI::App* Tree::group(const std::string& name, const std::string& what) {
  CLI::App* parent = device_.add_subcommand(name, what);
  parent->require_subcommand(1);
  return parent;
}

void Tree::add_output(CLI::App& command, DeviceOutput& output, const std::string& what_csv) {
  command.add_flag("--json", output.json, "machine-readable");
  if (!what_csv.empty()) command.add_option("--csv", output.csv, what_csv + " into a new file; - prints it");
}

void Tree::add_loop(CLI::App& command, MckibbenLoopOptions& loop) {
  command.add_option("--spec", loop.spec, "another description of such a device");
  number(command, "--kp", loop.gains.kp, "proportional gain, V/N (default: 0.28, the paper's)");
  number(command, "--ki", loop.gains.ki, "integral gain, V/(N s) (default: 0)");
  number(command, "--kd", loop.gains.kd, "derivative gain, V s/N (default: 0)");
  add_choice(command, "--tendon", loop.tendon, kTendons,
             "bilateral: it can push too, as the paper's (15); unilateral: as a real one (default: bilateral)");
}

void Tree::add_lists() {
  Arguments& all = *arguments_;
  CLI::App* command = add(device_, "list", "The rigs that there are, and the real devices that are connected", "list",
                          [&all] { return command_device_list(all.json); });
  command->add_flag("--json", all.json, "machine-readable");
  command = add(device_, "info", "Everything a rig's description, or a connected device, says of itself",
                "info rrs3\n  jnd device info FT-0001", [&all] { return command_device_info(all.rig, all.json); });
  command->add_option("RIG", all.rig, "a rig's name, a file that describes one, or a device's serial number or path")
      ->required();
  command->add_flag("--json", all.json, "machine-readable");
}

void Tree::add_models() {
  CLI::App* models = group("model", "Ask the models of the papers one question");
  Rrs3ModelOptions& rrs3 = arguments_->rrs3_model;
  CLI::App* command =
      add(*models, "rrs3", "Kinematics and statics of the 3RRS platform at a pose, or a map of its workspace",
          "model rrs3 --pose -0.018,0.2,-0.1 --wrench 0,0,2,0,0,0 --stiffness 700\n  jnd device model rrs3 --map\n"
          "  jnd device model rrs3 --batch poses.jsonl",
          [&rrs3] { return command_device_model_rrs3(rrs3); });
  command->add_option("--pose", rrs3.pose, "PZ,ROLL,PITCH: m, rad, rad");
  command->add_option("--geometry", rrs3.geometry, "JSON of a geometry, or of a device (default: the shipped device)");
  command->add_option("--wrench", rrs3.wrench, "FX,FY,FZ,MX,MY,MZ on the finger at the platform's centre: N, N m");
  number(*command, "--stiffness", rrs3.stiffness_n_per_m, "kS of the joint stiffness (35), N/m");
  number(*command, "--rotational", rrs3.rotational_n_m_per_rad, "kphi of it, N m/rad (default: kS read as N mm/rad)");
  command->add_option("--batch", rrs3.batch,
                      "a question a line, as JSON: {\"pz\", \"roll\", \"pitch\", \"geometry\"?: {\"a\", \"b\", \"bh\", "
                      "\"bd\", \"l1\", \"l2\", \"pz0\"}, \"wrench\"?, \"stiffness\"?, \"rotational\"?}; - reads "
                      "standard input. Answers are JSON lines");
  command->add_flag("--map", rrs3.map, "condition number over roll and pitch");
  number(*command, "--height", rrs3.height_m, "height of the map, m (default: the rest height)");
  add_output(*command, rrs3.output, "the map");

  MckibbenModelOptions& mckibben = arguments_->mckibben_model;
  command = add(*models, "mckibben", "Linkage, muscle and air of the McKibben finger",
                "model mckibben --angle 0.6\n  jnd device model mckibben --pressure 200000 --length 0.13\n"
                "  jnd device model mckibben --upstream 500000 --muscle 150000\n  jnd device model mckibben --sweep",
                [&mckibben] { return command_device_model_mckibben(mckibben); });
  command->add_option("--spec", mckibben.spec, "another description of such a device");
  number(*command, "--angle", mckibben.angle_rad, "of the rocker, rad: linkage and static force");
  number(*command, "--pressure", mckibben.pressure_pa, "gauge, Pa, with --length: force of the muscle, (14)");
  number(*command, "--length", mckibben.length_m, "of the muscle, m");
  number(*command, "--upstream", mckibben.upstream_pa, "absolute, Pa, with --muscle: mass flow into the muscle, (11)");
  number(*command, "--muscle", mckibben.muscle_pa, "absolute, Pa");
  command->add_flag("--sweep", mckibben.sweep, "force without pressure and force per bar, from straight to flexed");
  add_output(*command, mckibben.output, "the sweep");
}

void Tree::add_responses() {
  CLI::App* parent = group("step", "The answer to a step of the commanded force");
  DeviceStepOptions& step = arguments_->step;
  CLI::App* command =
      add(*parent, "mckibben", "Step response of the force loop",
          "step mckibben --kp 0.7 --from 0 --to 5 --angle 0.351181", [&step] { return command_device_step(step); });
  add_loop(*command, step.loop);
  number(*command, "--angle", step.angle_rad, "of the rocker, rad (default: straight)");
  number(*command, "--from", step.from_n, "force commanded before, N (default: 0)");
  number(*command, "--to", step.to_n, "force commanded then, N (default: 5)");
  number(*command, "--duration", step.duration_s, "s (default: 1.2)");
  add_output(*command, step.output, "the curve");

  parent = group("bode", "The frequency response of the commanded force");
  DeviceBodeOptions& bode = arguments_->bode;
  command = add(*parent, "mckibben", "Frequency response of the force loop, at an amplitude",
                "bode mckibben --kp 0.7 --mean 10 --amplitude 8 --angle 0.351181",
                [&bode] { return command_device_bode(bode); });
  add_loop(*command, bode.loop);
  number(*command, "--angle", bode.angle_rad, "of the rocker, rad (default: straight)");
  number(*command, "--mean", bode.mean_n, "of the commanded force, N (default: 10)");
  number(*command, "--amplitude", bode.amplitude_n, "of it, N (default: 8)");
  number(*command, "--frequencies", bode.frequencies_rad_per_s, "W1,W2,... rad/s (default: 1 to 1000)")->delimiter(',');
  command->add_option("--settle", bode.settle_cycles, "whole cycles to let pass (default: 6)")
      ->check(CLI::Range(1, 10'000));
  command->add_option("--measure", bode.measure_cycles, "whole cycles to measure then (default: 3)")
      ->check(CLI::Range(1, 10'000));
  add_output(*command, bode.output, "the curve");

  parent = group("track", "How the commanded force is followed while the finger flexes");
  DeviceTrackOptions& track = arguments_->track;
  command =
      add(*parent, "mckibben", "Tracking of a virtual object's force during flexion",
          "track mckibben --kobj 8,20,50 --kp 0.28 --frequency 0.5", [&track] { return command_device_track(track); });
  add_loop(*command, track.loop);
  number(*command, "--kobj", track.kobj_n_per_rad, "stiffness of the object, N/rad; several with commas")
      ->delimiter(',')
      ->required();
  number(*command, "--frequency", track.frequency_hz, "of the flexion, Hz (default: 0.5)");
  add_output(*command, track.output, "the table");

  parent = group("onset", "Where the force loop begins to oscillate");
  DeviceOnsetOptions& onset = arguments_->onset;
  command = add(*parent, "mckibben", "KP*: the least gain of P control that oscillates, at each angle",
                "onset mckibben --angle 0.351181,0.610865", [&onset] { return command_device_onset(onset); });
  command->add_option("--spec", onset.spec, "another description of such a device");
  number(*command, "--angle", onset.angles_rad, "of the rocker, rad; several with commas (default: straight to flexed)")
      ->delimiter(',');
  add_output(*command, onset.output, "the table");
}

void Tree::add_stiffnesses() {
  CLI::App* parent = group("stiffness", "The stiffness that a device really renders");
  Rrs3StiffnessOptions& rrs3 = arguments_->rrs3_stiffness;
  CLI::App* command = add(*parent, "rrs3", "Pressed through the governor, settled, and fitted",
                          "stiffness rrs3 --stiffness 500,900 --mode pd --finger 1000",
                          [&rrs3] { return command_device_stiffness_rrs3(rrs3); });
  command->add_option("--spec", rrs3.spec, "another description of such a device");
  number(*command, "--stiffness", rrs3.stiffness_n_per_m, "kS, N/m; several with commas")->delimiter(',')->required();
  add_choice(*command, "--mode", rrs3.mode, kModes, "rendering: wrench, pd or pd-literal (default: wrench)");
  number(*command, "--finger", rrs3.finger_n_per_m, "stiffness of the finger's pulp, N/m (default: 1000)");
  number(*command, "--roll", rrs3.roll_rad, "of the surface, rad (default: 0)");
  number(*command, "--pitch", rrs3.pitch_rad, "of the surface, rad (default: 0)");
  add_output(*command, rrs3.output, "force over depth");

  MckibbenStiffnessOptions& mckibben = arguments_->mckibben_stiffness;
  command =
      add(*parent, "mckibben", "Fitted while the finger flexes against the object",
          "stiffness mckibben --stiffness 8,50", [&mckibben] { return command_device_stiffness_mckibben(mckibben); });
  command->add_option("--spec", mckibben.spec, "another description of such a device");
  number(*command, "--stiffness", mckibben.stiffness_n_per_rad, "of the object, N/rad; several with commas")
      ->delimiter(',')
      ->required();
  number(*command, "--kp", mckibben.kp, "V/N (default: both the paper's P control and the device's own)");
  number(*command, "--ki", mckibben.ki, "V/(N s)");
  number(*command, "--kd", mckibben.kd, "V s/N");
  add_choice(*command, "--tendon", mckibben.tendon, kTendons, "bilateral or unilateral (default: the device's own)");
  number(*command, "--frequency", mckibben.frequency_hz, "of the flexion, Hz (default: 0.5)");
  add_output(*command, mckibben.output, "the table");
}

void Tree::add_test() {
  Arguments& all = *arguments_;
  CLI::App* command =
      add(device_, "test", "Self-test of a rig, or test of a connected device", "test rrs3\n  jnd device test FT-0001",
          holding_interrupts([&all] { return command_device_test(all.rig, all.json, all.yes); }));
  command->add_option("RIG", all.rig, "a rig's name, a file that describes one, or a device's serial number or path")
      ->required();
  command->add_flag("--yes", all.yes, "a real device may press (0.5 N) and vibrate without being asked for");
  command->add_flag("--json", all.json, "machine-readable");
}

void Tree::add_calibrate() {
  DeviceCalibrateOptions& calibrate = arguments_->calibrate;
  CLI::App* command = add(device_, "calibrate", "Calibrate a connected device's force, and check its stiffness",
                          "calibrate FT-0001 --operator \"A. Smith\" --reference-name \"scale 17\" --push 1,2,4,2,1\n"
                          "  jnd device calibrate FT-0001 --operator \"A. Smith\" --reference-name \"weights\" "
                          "--reference points.csv --store",
                          holding_interrupts([&calibrate] { return command_device_calibrate(calibrate); }));
  command->add_option("DEVICE", calibrate.name, "a serial number or a path, as jnd device list shows them")->required();
  command->add_option("--reference", calibrate.reference,
                      "interactive: known forces are typed; or a CSV file of them: known_n (N), and pushed_n (N) where "
                      "the device presses the reference (default: interactive)");
  command
      ->add_option("--push", calibrate.push_n,
                   "N1,N2,...: forces with which the device presses the reference; what that shows is typed")
      ->delimiter(',')
      ->check(finite());
  command->add_option("--operator", calibrate.operator_name, "who calibrates")->required();
  command
      ->add_option("--reference-name", calibrate.reference_name, "which scale or weights, such as an inventory number")
      ->required();
  command->add_option("--remarks", calibrate.remarks, "anything that should stand in the certificate");
  command->add_option("--out", calibrate.out, "the certificate's file (default: SERIAL-DATE-ID.json in this folder)");
  command->add_flag("--no-stiffness", calibrate.no_stiffness, "leave the check of 500, 700 and 900 N/m out");
  command->add_flag("--store", calibrate.store, "write table and certificate into the device, where it passes");
  command->add_flag("--yes", calibrate.yes, "the device may press without being asked for");
  command->add_flag("--json", calibrate.json, "print the certificate");
}

void Tree::add_learn_buttons() {
  LearnButtonsOptions& learn = arguments_->learn_buttons;
  CLI::App* command =
      add(device_, "learn-buttons", "Learn which buttons of a gamepad, keypad or pedal mean same and different",
          "learn-buttons --to pedals.json --stop",
          holding_interrupts([&learn] { return command_device_learn_buttons(learn); }));
  command->add_option("--to", learn.file, "the mapping to write, for jnd run --buttons; it must not exist")->required();
  command->add_option("--device", learn.device, "its path, such as /dev/hidraw0 (default: the only one, or asked for)");
  command->add_flag("--stop", learn.with_stop, "also a button that stops the devices at any time");
  command->add_option("--debounce", learn.debounce_ms, "how long a contact may bounce, ms (default: 10)")
      ->check(CLI::Range(0, 200));
}

}  // namespace

void add_device_commands(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* device = app.add_subcommand("device", "What the devices and their models do: test, measure, ask");
  device->require_subcommand(1);
  device->footer("Example:\n  jnd device test rrs3");
  Tree tree(*device, chosen);
  tree.add_lists();
  tree.add_models();
  tree.add_responses();
  tree.add_stiffnesses();
  tree.add_test();
  tree.add_calibrate();
  tree.add_learn_buttons();
}

}  // namespace jnd
