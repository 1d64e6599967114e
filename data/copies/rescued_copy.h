// The copy in which a session went on after its study's file was taken away (study_rescue.cpp).
#pragma once

#include <filesystem>

namespace jnd {

// "study-rescued.sqlite", "study-rescued-2.sqlite", ...; n: from 1.
std::filesystem::path rescued_name(const std::filesystem::path& study, int n);

// Throws StorageError, which names the copy, if one lies beside the study's name and holds events that the study lacks,
// or the study is not there or cannot be read.
void refuse_rescued(const std::filesystem::path& study);

}  // namespace jnd
