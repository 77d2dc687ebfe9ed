// resume.json: where `track --resume` goes on. Kept beside the table, for this program alone.
#pragma once

#include <filesystem>

#include "host/track/resume_point.h"

namespace impactdic {

// Replaces the file in one step. Throws FileError.
void write_resume_point(const std::filesystem::path& path, const ResumePoint& point);

// Every number comes back to the last bit. Throws FileError, FormatError.
ResumePoint read_resume_point(const std::filesystem::path& path);

}  // namespace impactdic
