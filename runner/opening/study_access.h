// How the commands come to a protocol, its device and a study.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "data/results/study_results.h"
#include "data/study/study.h"
#include "devices/rigs/rig_factory.h"
#include "protocols/protocol.h"

namespace jnd {

// A protocol that can be run (protocol_fitness.h). Throws InputError with every mistake.
Protocol load_checked_protocol(const std::string& name_or_path);
// The files that the protocol's rig names: its devices, and its virtual object. Throw InputError.
RigSpec rig_spec_of(const Protocol& protocol);
RigDescription rig_of(const Protocol& protocol);

// For commands that add to a study. Throws BrokenChain where verify() (data/verify/verify.h) finds a problem in it; the
// file stays as it is.
void require_sound(const std::filesystem::path& study);
// Opens the study, or makes it where there is none: with the given seed, or a drawn one.
// Throws UsageError where the study has another seed than the one asked for, InputError where it has another protocol,
// StorageError where a session of it went on in a rescued copy.
std::unique_ptr<Study> open_or_create_study(const std::filesystem::path& path, const Protocol& protocol,
                                            std::optional<std::uint64_t> seed, Stamp stamp);

// The protocol that a study keeps. Throws InputError where this version cannot read it.
Protocol protocol_of(const Study& study);

// The kind to analyse: the one named, else the only one there is, else real. Throws UsageError.
SessionKind kind_to_analyse(const Study& study, const std::optional<std::string>& named);
// The kinds that an analysis left out, said on standard output.
void say_other_kinds(const Study& study, SessionKind analysed);

// The stiffness differences to analyse by: "nominal" or "delivered", or what the protocol registers. Throws UsageError.
DifferenceSource source_to_analyse(const Protocol& protocol, const std::optional<std::string>& named);

}  // namespace jnd
