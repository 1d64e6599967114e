// Can a protocol be run? The one place that decides it: `jnd check` prints what it finds, every other command refuses
// a protocol with errors.
#pragma once

#include <filesystem>

#include "protocols/reading/protocol_json.h"

namespace jnd {

// The protocol file itself, what it asks of its devices, the files that it names (device, objects), and its rig, put
// together and moved by a simulated hand. Each mistake has its place in the file. Where poses come from a tracker that
// is simulated only in rehearsals, a rig that cannot be rehearsed is a warning.
// Throws InputError where the file cannot be read.
ProtocolCheck check_fitness(const std::filesystem::path& path);
// The same of a protocol that is in no file yet. file: what messages call it.
ProtocolCheck check_fitness_of(std::string bytes, const std::string& file);

}  // namespace jnd
