// jnd device model rrs3 --batch: the 3RRS model's answers to many poses, JSON lines in and out.
#include <cmath>
#include <cstdio>
#include <iostream>
#include <sstream>

#include <fmt/format.h>

#include "protocols/input/input_error.h"
#include "protocols/input/json_reader.h"
#include "protocols/input/read_file.h"
#include "runner/device_commands/device_output.h"
#include "runner/device_commands/rrs3_answer.h"
#include "runner/terminal/exit_code.h"
#include "runner/terminal/standard_streams.h"
#include "runner/terminal/terminal.h"

namespace jnd {

nlohmann::ordered_json rrs3_answer_json(const Rrs3ModelAnswer& answer) {
  return {{"yaw", json_number(answer.yaw)}, {"p", json_vector(answer.p)},       {"b", json_rows(answer.b)},
          {"d", json_rows(answer.d)},       {"q", json_vector(answer.q)},       {"j_chi", json_rows(answer.j_chi)},
          {"j_xi", json_rows(answer.j_xi)}, {"h", json_rows(answer.h)},         {"tau", json_vector(answer.tau)},
          {"kq", json_rows(answer.kq)},     {"cond", json_number(answer.cond)}, {"det_ux", json_number(answer.det_ux)}};
}

void check_rrs3_query(const Rrs3ModelQuery& query) {
  constexpr double kMost = 1e6;
  if (!(query.translational_n_per_m >= 0) || query.translational_n_per_m > kMost)
    throw InputError(fmt::format("a stiffness of {:g} N/m: give 0 to {:g}", query.translational_n_per_m, kMost));
  if (!(query.rotational_n_m_per_rad >= 0) || query.rotational_n_m_per_rad > kMost)
    throw InputError(
        fmt::format("a rotational stiffness of {:g} N m/rad: give 0 to {:g}", query.rotational_n_m_per_rad, kMost));
  for (const double part : query.wrench)
    if (!(std::abs(part) <= kMost))
      throw InputError(fmt::format("a wrench with {:g} in it: give N and N m, at most {:g}", part, kMost));
}

namespace {

Rrs3ModelQuery query_of(const std::string& line, const std::string& file, const Rrs3Geometry& default_geometry) {
  const JsonNode root = parse_json(line, file);
  std::vector<Diagnostic> diagnostics;
  JsonReader reader(root, diagnostics, file);
  Rrs3ModelQuery query;
  query.geometry = default_geometry;
  if (const JsonNode* geometry = reader.object_or_null("geometry")) {
    try {
      query.geometry = rrs3_geometry_from_json(*geometry, file);
    } catch (const InputError& error) {  // beside the line's other mistakes
      diagnostics.insert(diagnostics.end(), error.diagnostics().begin(), error.diagnostics().end());
    }
  }
  query.coordinates = {.pz_m = reader.number("pz", {.unit = "m"}),
                       .roll_rad = reader.number("roll", {.unit = "rad"}),
                       .pitch_rad = reader.number("pitch", {.unit = "rad"})};
  if (const JsonNode* wrench = reader.array_or_null("wrench", 6, 6))
    for (std::size_t i = 0; i < 6; ++i)
      query.wrench[static_cast<Eigen::Index>(i)] =
          number_of(wrench->items[i], {.unit = i < 3 ? "N" : "N m"}, diagnostics, file).value_or(0);
  query.translational_n_per_m = reader.number_or("stiffness", 0, {.min = 0, .unit = "N/m"});
  query.rotational_n_m_per_rad =
      reader.number_or("rotational", 1e-3 * query.translational_n_per_m, {.min = 0, .unit = "N m/rad"});
  reader.finish();
  if (!diagnostics.empty()) throw InputError(std::move(diagnostics));
  check_rrs3_query(query);
  return query;
}

// Each message of a line with the line's own number in the file.
std::string located(const InputError& error, const std::string& file, int line) {
  std::string text;
  for (Diagnostic diagnostic : error.diagnostics()) {
    diagnostic.file = file;
    diagnostic.line = line;
    if (diagnostic.column == 0) diagnostic.column = 1;
    text += (text.empty() ? "" : "\n") + to_text(diagnostic);
  }
  return text;
}

constexpr std::size_t kMostBatchBytes = std::size_t{64} << 20U;
constexpr std::size_t kLongestLine = std::size_t{1} << 20U;

// The next line of a stream that may be anything; false at its end. Throws InputError where a line has no end.
bool next_line(std::istream& in, std::string& line, const std::string& name, int number) {
  line.clear();
  for (int byte = in.get(); in; byte = in.get()) {
    if (byte == '\n') return true;
    if (line.size() == kLongestLine)
      throw InputError(std::vector<Diagnostic>{
          {name, number, 1, "", "the line is longer than 1 MiB", "give one question a line, as JSON"}});
    line += static_cast<char>(byte);
  }
  return !line.empty();
}

bool blank(const std::string& line) {
  return line.find_first_not_of(" \t\r") == std::string::npos;
}

}  // namespace

int answer_rrs3_batch(const Rrs3ModelOptions& options) {
  if (!options.wrench.empty() || options.stiffness_n_per_m != 0 || options.rotational_n_m_per_rad)
    throw UsageError("a batch brings its own wrench and stiffness: give them in its lines");
  const Rrs3Geometry geometry = options.geometry.empty() ? geometry_of(device_named("rrs3", DeviceModel::rrs3))
                                                         : load_rrs3_geometry(options.geometry);
  const bool standard_input = options.batch == "-";
  const std::string name = standard_input ? "standard input" : options.batch;
  std::istringstream file;
  if (!standard_input) file.str(read_input_file(options.batch, kMostBatchBytes));
  std::istream& in = standard_input ? std::cin : file;
  bool all_sound = true;
  int number = 0;
  for (std::string line; next_line(in, line, name, number + 1);) {
    ++number;
    if (blank(line)) continue;
    // A bad line has its answer too, so that the others keep their places.
    nlohmann::ordered_json answer;
    try {
      const std::optional<Rrs3ModelAnswer> model = ask_rrs3_model(query_of(line, name, geometry));
      if (model) {
        answer = rrs3_answer_json(*model);
        answer["status"] = "ok";
      } else {
        answer["status"] = "unreachable";
      }
    } catch (const InputError& error) {
      all_sound = false;
      const std::string message = located(error, name, number);
      write_marked_message(message);
      answer = {{"status", "invalid"}, {"line", number}, {"message", message}};
    }
    print_json(answer);
    std::fflush(stdout);  // who asks through a pipe waits for the answer
  }
  if (in.bad()) throw InputError(fmt::format("{} could not be read to its end", name));
  return all_sound ? exit_code::kDone : exit_code::kInvalidInput;
}

}  // namespace jnd
