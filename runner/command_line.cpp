#include "runner/command_line.h"

#include <functional>
#include <sstream>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "protocols/version.h"
#include "runner/calc/calc.h"
#include "runner/commands/care_commands.h"
#include "runner/commands/commands.h"
#include "runner/commands/precision_options.h"
#include "runner/commands/report_command.h"
#include "runner/device_commands/device_commands.h"
#include "runner/keys/interrupt.h"
#include "runner/terminal/command_outcome.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/standard_streams.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

// Adds a command whose help ends with an example.
CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& what, const std::string& example) {
  CLI::App* command = app.add_subcommand(name, what);
  command->footer("Example:\n  " + example);
  return command;
}

// Reads the arguments and runs the command that they choose.
int parse_and_run(int argc, const char* const* argv) {
  CLI::App app{"jnd: plan, rehearse, run and analyse stiffness-discrimination studies", "jnd"};
  app.set_version_flag("--version", std::string("jnd ") + kVersion);
  app.require_subcommand(1);
  app.footer(
      "Start here:\n  jnd new my-study.json          a protocol to start from\n"
      "  jnd check my-study.json        what is wrong with it, where\n"
      "  jnd simulate chinello2017 --participants 18 --study s.sqlite\n"
      "  jnd analyze s.sqlite           d', JND, Weber fractions");
  std::function<int()> chosen;

  NewOptions make;
  CLI::App* command =
      add_command(app, "new", "Write a protocol to start from", "jnd new my-study.json --from chinello2017-balanced");
  command->add_option("FILE", make.file, "the file to write; it must not exist")->required();
  command->add_option("--from", make.from, "the shipped protocol to copy (default: tutorial)");
  command->callback([&] { chosen = holding_interrupts([&] { return command_new(make); }); });

  CheckOptions check;
  command = add_command(app, "check", "Find every mistake in a protocol", "jnd check my-study.json");
  command->add_option("PROTOCOL", check.protocols, "protocol files or names of shipped ones")->required();
  command->add_flag("--json", check.json, "one JSON object a file");
  command->callback([&] { chosen = [&] { return command_check(check); }; });

  PlanOptions plan;
  PrecisionOptions precision;
  command = add_command(app, "plan", "Print the trials of a participant, or the balance of a cohort",
                        "jnd plan chinello2017 --participant 7 --seed 1");
  command->add_option("PROTOCOL", plan.protocol,
                      "protocol file, or name of a shipped one (with --precision: chinello2017 where none is named)");
  command->add_option("--participant", plan.participant, "participant number, from 1")->check(CLI::Range(1, 100'000));
  command->add_option("--session", plan.session, "which of the participant's sessions, from 1 (default: 1)")
      ->check(CLI::Range(1, 20));
  command->add_option("--cohort", plan.cohort, "show the balance over participants 1..N instead")
      ->check(CLI::Range(1, 10'000));
  command->add_option("--seed", plan.seed, "the study's seed (default: 1)");
  command->add_option("--study", plan.study, "the plan of a study's participant, by its own protocol and seed");
  command->add_flag("--json", plan.json, "machine-readable");
  add_precision_options(*command, precision);
  command->callback([&] {
    if (plan.protocol.empty() && !precision.asked && !plan.study) throw CLI::RequiredError("PROTOCOL");
    if (precision.asked && plan.study) throw CLI::ExcludesError("--precision", "--study");
    if (plan.protocol.empty() && !plan.study) plan.protocol = "chinello2017";
    chosen = [&] { return precision.asked ? command_plan_precision(plan, precision) : command_plan(plan); };
  });

  RunOptions run;
  command = add_command(app, "run", "Run a session from this terminal, or go on with one",
                        "jnd run tutorial --study pilot.sqlite --participant P01");
  command->add_option("PROTOCOL", run.protocol, "protocol file, or name of a shipped one")->required();
  command->add_option("--study", run.study, "the study's file; made where it does not exist")->required();
  command->add_option("--participant", run.participant,
                      "participant code (letters and digits); asked for if not given");
  command->add_option("--seed", run.seed, "seed of a new study (default: drawn, and kept in the study)");
  command->add_option("--responder", run.responder, "a live demonstration: this profile answers instead of a person");
  command->add_flag("--participant-presses", run.participant_presses,
                    "the participant presses the answer keys (otherwise the operator enters what is said)");
  command->add_option("--buttons", run.buttons,
                      "the participant answers with buttons: a mapping of jnd device learn-buttons");
  command->add_option("--language", run.language, "language of the participant's texts, of those in the protocol");
  command->add_flag("--plain", run.plain, "a line at a time instead of a full screen: for screen readers and scripts");
  command->add_option("--kind", run.kind, "real (default on a real rig) or pilot (default on a simulated one)");
  command->add_flag("--new", run.beside, "begin this participant while another one's session is unfinished");
  command->add_option("--accept-gap", run.accept_gap,
                      "go on after a longer interruption than the protocol allows, for this reason");
  command->add_option("--override-readiness", run.override_readiness,
                      "begin in spite of what the readiness check found, for this reason");
  command->add_option("--rig", run.rig,
                      "simulated (default), hid (the connected devices), or a rig file that says who wears which");
  command->add_flag("--fast", run.fast, "rehearse without waiting: stimuli and pauses take no time");
  command->add_option("--record", run.record, "what is kept: off, events (faults), full (every tick; default)")
      ->check(CLI::IsMember({"off", "events", "full"}));
  command->add_option("--realtime", run.realtime, "real-time scheduling: off, prefer (default), require")
      ->check(CLI::IsMember({"off", "prefer", "require"}));
  command->callback([&] { chosen = holding_interrupts([&] { return command_run(run); }); });

  SimulateOptions simulate;
  command = add_command(app, "simulate", "Run simulated participants through the study",
                        "jnd simulate chinello2017 --participants 18 --study s.sqlite --seed 1");
  command->add_option("PROTOCOL", simulate.protocol, "protocol file, or name of a shipped one")->required();
  command->add_option("--study", simulate.study, "the study's file; made where it does not exist");
  command->add_option("--participants", simulate.participants, "how many, numbered from 1")
      ->check(CLI::Range(1, 100'000));
  command->add_option("--seed", simulate.seed, "seed of a new study (default: drawn, printed and kept in the study)");
  command->add_option("--profile", simulate.profile, "profile file, or name of a shipped one (default: what fits)");
  command->add_option("--threads", simulate.threads, "participants at a time (default: one a processor)")
      ->check(CLI::Range(1, 1024));
  command->add_option("--record", simulate.record, "what is kept: off, events (faults; default), full (every tick)")
      ->check(CLI::IsMember({"off", "events", "full"}));
  command->add_flag("--no-study", simulate.no_study, "keep nothing: print the group's result only");
  command->add_flag("--json", simulate.json, "machine-readable result of --no-study");
  command->callback([&] { chosen = holding_interrupts([&] { return command_simulate(simulate); }); });

  StudyOptions status;
  command = add_command(app, "status", "What a study holds", "jnd status s.sqlite");
  command->add_option("STUDY", status.study, "the study's file")->required();
  command->add_flag("--json", status.json, "machine-readable");
  command->callback([&] { chosen = [&] { return command_status(status); }; });

  StudyOptions verified;
  command = add_command(app, "verify", "Recompute every hash and every planned stimulus", "jnd verify s.sqlite");
  command->add_option("STUDY", verified.study, "the study's file")->required();
  command->add_flag("--deep", verified.deep,
                    "also every number that telemetry gives, the course of every session, and the file itself");
  command->add_flag("--json", verified.json, "machine-readable");
  command->callback([&] { chosen = [&] { return command_verify(verified); }; });

  AnalyzeOptions analyze;
  command = add_command(app, "analyze", "d', JND and Weber fractions by the registered plan", "jnd analyze s.sqlite");
  command->add_option("STUDY", analyze.study, "the study's file")->required();
  command->add_option("--kind", analyze.kind, "real, pilot or simulated (default: the only one, or real)");
  command
      ->add_option("--by", analyze.by,
                   "slopes over nominal or delivered stiffness differences (default: what the protocol registers)")
      ->check(CLI::IsMember({"nominal", "delivered"}));
  command->add_option("--models", analyze.models, "registered (default), or all: every model beside it")
      ->check(CLI::IsMember({"registered", "all"}));
  command->add_flag("--cells", analyze.cells, "also every cell: counts, rates, z and d'");
  command->add_option("--csv", analyze.csv, "also the results as CSV files in this folder");
  command->add_flag("--replace", analyze.replace, "replace the CSV folder of an earlier analysis");
  command->add_option("--methods", analyze.methods,
                      "the file for the methods in words (default: methods.md beside the study)");
  command->add_flag("--no-methods", analyze.no_methods, "write no methods file");
  command->add_flag("--json", analyze.json, "machine-readable");
  command->callback([&] { chosen = [&] { return command_analyze(analyze); }; });

  ExportOptions exported;
  command = add_command(app, "export", "Write tidy CSV files with a dictionary of every column",
                        "jnd export s.sqlite --to results");
  command->add_option("STUDY", exported.study, "the study's file")->required();
  command->add_option("--to", exported.folder, "the folder to write")->required();
  command->add_option("--kind", exported.kind, "real, pilot or simulated (default: the only one, or real)");
  command
      ->add_option("--by", exported.by,
                   "slopes over nominal or delivered stiffness differences (default: what the protocol registers)")
      ->check(CLI::IsMember({"nominal", "delivered"}));
  command->add_flag("--telemetry", exported.telemetry, "also every tick of every interval, a file each");
  command->add_flag("--replace", exported.replace, "replace the folder of an earlier export");
  command->callback([&] { chosen = [&] { return command_export(exported); }; });

  ReportOptions report;
  command =
      add_command(app, "report", "Write a page for people: figures, tables, warnings, methods", "jnd report s.sqlite");
  command->add_option("STUDY", report.study, "the study's file")->required();
  command->add_option("--to", report.file, "the page (default: the study's name with -report.html, beside it)");
  command->add_option("--figures", report.figures_folder,
                      "the folder for the figures as SVG files (default: the page's name with -figures)");
  command->add_option("--kind", report.kind, "real, pilot or simulated (default: the only one, or real)");
  command
      ->add_option("--by", report.by,
                   "slopes over nominal or delivered stiffness differences (default: what the protocol registers)")
      ->check(CLI::IsMember({"nominal", "delivered"}));
  command->add_flag("--replace", report.replace, "replace an earlier report");
  command->callback([&] { chosen = [&] { return command_report(report); }; });

  DoctorOptions doctor;
  command = add_command(app, "doctor", "Is this machine fit to run a session", "jnd doctor --study studies");
  command->add_option("--study", doctor.study, "a study, or the folder where studies go (default: this folder)");
  command->add_option("--seconds", doctor.seconds, "length of each of the two measurements of lateness (default: 3)")
      ->check(CLI::Range(0.1, 600.0));
  command->add_option("--protocol", doctor.protocol, "is the machine fit for this one too: has it the tracker");
  command->add_option("--rig", doctor.rig, "and for this rig file: are its devices, tracker and buttons there");
  command->add_flag("--json", doctor.json, "machine-readable");
  command->callback([&] { chosen = holding_interrupts([&] { return command_doctor(doctor); }); });

  add_care_commands(app, chosen);
  add_calc_commands(app, chosen);
  add_device_commands(app, chosen);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream out, err;
    const int code = app.exit(error, out, err);  // help, version or the message, which quotes arguments
    fmt::print("{}", printable_lines(out.str()));
    write_message(printable_lines(err.str()));
    return code == 0 ? exit_code::kDone : exit_code::kUsage;
  }
  return chosen();
}

}  // namespace

int run_command_line(int argc, const char* const* argv) {
  keep_standard_streams();
  install_interrupt_handlers();
  return outcome_of([&] { return parse_and_run(argc, argv); });
}

}  // namespace jnd
