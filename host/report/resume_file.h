// resume.json: where `track --resume` and `correlate --resume` go on. Kept beside the table, for
// this program alone.
#pragma once

#include <filesystem>

#include "host/pipeline/resume_point.h"

namespace impactdic::report {

// Replaces the file in one step. Throws FileError.
void write_resume_point(const std::filesystem::path& path, const pipeline::ResumePoint& point);

void write_resume_point(const std::filesystem::path& path, const pipeline::CorrelatePoint& point);

// Every number comes back to the last bit. Throws FileError; FormatError where the file is damaged
// or says what no run of this program does.
pipeline::ResumePoint read_resume_point(const std::filesystem::path& path);
pipeline::CorrelatePoint read_correlate_point(const std::filesystem::path& path);

}  // namespace impactdic::report
